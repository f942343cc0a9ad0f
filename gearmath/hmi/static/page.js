// What the browser alone can know: whether the server still talks to it.
function gearmathChoose(cookie, value) {
  document.cookie = `${cookie}=${value}; SameSite=Strict; Path=/; Max-Age=31536000`;
  location.reload();
}

(function () {
  let before = Date.now();
  setInterval(() => {
    const now = Date.now();
    const slept = now - before > 5000;
    before = now;
    const socket = window.socket;
    const lost = slept || (window.did_handshake === true && !(socket && socket.connected));
    if (document.body.classList.contains("gm-is-lost") !== lost) {
      document.body.classList.toggle("gm-is-lost", lost);
      // nothing is pressed while nobody hears it: a browser would send it later
      for (const part of document.querySelectorAll(".gm-head, .gm-nav, .gm-main")) part.inert = lost;
    }
  }, 250);
})();
