// What the browser alone can know: whether the server still talks to it.
function gearmathChoose(cookie, value) {
  document.cookie = `${cookie}=${value}; SameSite=Strict; Path=/; Max-Age=31536000`;
  location.reload();
}

(function () {
  const silence = 4000; // ms without the beat of the server, which comes every second
  let beat = "", heard = Date.now();
  setInterval(() => {
    const now = document.querySelector(".gm-beat")?.textContent ?? "";
    if (now !== beat) {
      beat = now;
      heard = Date.now();
    }
    const socket = window.socket;
    const lost = Date.now() - heard > silence || (window.did_handshake === true && !(socket && socket.connected));
    if (document.body.classList.contains("gm-is-lost") !== lost) {
      document.body.classList.toggle("gm-is-lost", lost);
      // nothing is pressed while nobody hears it: a browser would send it later
      for (const part of document.querySelectorAll(".gm-head, .gm-nav, .gm-main")) part.inert = lost;
    }
  }, 250);
})();
