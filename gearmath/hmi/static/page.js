// What the browser alone can know: whether the server hears what is pressed and typed here.
function gearmathChoose(cookie, value) {
  document.cookie = `${cookie}=${value}; SameSite=Strict; Path=/; Max-Age=31536000`;
  location.reload();
}

(function () {
  const silence = 4000; // ms without the beat of the server, which comes every second
  const parts = ".gm-head, .gm-nav, .gm-main, .q-dialog, .q-menu";
  let beat = "", heard = Date.now(), left = null;

  // nothing is pressed while nobody hears it, from the first picture on: it would be lost, or sent later
  function open(live) {
    const focused = document.activeElement;
    for (const part of document.querySelectorAll(parts)) {
      if (part.inert !== live) continue;
      if (!live && part.contains(focused)) left = focused;
      part.inert = !live;
    }
    if (live && left !== null) {
      if (left.isConnected && document.activeElement === document.body) left.focus({ preventScroll: true });
      left = null;
    }
  }

  setInterval(() => {
    const now = document.querySelector(".gm-beat")?.textContent ?? "";
    if (now !== beat) {
      beat = now;
      heard = Date.now();
    }
    const began = window.did_handshake === true, connected = began && window.socket.connected;
    const silent = Date.now() - heard > silence;
    document.body.classList.toggle("gm-is-lost", silent || (began && !connected));
    document.body.classList.toggle("gm-is-live", connected && !silent);
    open(connected && !silent);
  }, 100);
})();
