// The token: from the address's fragment, which the browser sends nowhere, then kept for this tab alone.
const KEY = "hilplant-token";
const given = new URLSearchParams(location.hash.slice(1)).get("token");
if (given) {
  sessionStorage.setItem(KEY, given);
  history.replaceState(null, "", location.pathname + location.search);
}

export function token() {
  return sessionStorage.getItem(KEY) || "";
}

// Ask the server under /api; the answer's JSON, or an Error with the server's own words.
export async function api(path, body) {
  const headers = { authorization: `Bearer ${token()}` };
  const options = { headers, method: body === undefined ? "GET" : "POST" };
  if (body !== undefined) {
    headers["content-type"] = "application/json";
    options.body = JSON.stringify(body);
  }
  const answer = await fetch(`/api/${path}`, options);
  if (!answer.ok) throw new Error((await answer.text()).trim() || answer.statusText);
  return answer.json();
}
