// Dark or light: as the system has it, until the user says otherwise.
const KEY = "hilplant-theme";

export function theme() {
  const chosen = localStorage.getItem(KEY);
  return chosen || (matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark");
}

export function setTheme(name) {
  localStorage.setItem(KEY, name);
  document.documentElement.dataset.theme = name;
  dispatchEvent(new Event("themechange"));
}

export function toggleTheme() {
  setTheme(theme() === "dark" ? "light" : "dark");
}

export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

document.documentElement.dataset.theme = theme();
