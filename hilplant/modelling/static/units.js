// Units in which a value may be written; each with what one of it is in the unit of the file.
const PER_RPM = 30 / Math.PI;
const DEG = Math.PI / 180;

export const UNITS = {
  "V s/rad": [["V s/rad", 1], ["V/rpm", PER_RPM]],
  "N m s/rad": [["N m s/rad", 1]],
  rad: [["rad", 1], ["deg", DEG]],
  deg: [["deg", 1], ["rad", 1 / DEG]],
  "rad/s": [["rad/s", 1], ["1/min", Math.PI / 30]],
  "kg m2": [["kg m2", 1], ["g cm2", 1e-7]],
  H: [["H", 1], ["mH", 1e-3], ["uH", 1e-6]],
  ohm: [["ohm", 1], ["mohm", 1e-3]],
  "N m": [["N m", 1], ["mN m", 1e-3]],
  m: [["m", 1], ["mm", 1e-3]],
  "m/s": [["m/s", 1], ["km/h", 1 / 3.6]],
};

export function shown(value, factor = 1) {
  return typeof value === "number" ? String(Number((value / factor).toPrecision(12))) : "";
}

// A number as the user wrote it, in the unit of the file; NaN for what is none.
export function read(text, factor = 1) {
  const plain = text.trim().replace(",", ".");
  if (!/^[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$/.test(plain)) return NaN;
  return factor === 1 ? Number(plain) : Number((Number(plain) * factor).toPrecision(15));
}
