// What the browser alone can know: whether the server hears what is pressed and typed here.
function gearmathChoose(cookie, value) {
  document.cookie = `${cookie}=${value}; SameSite=Strict; Path=/; Max-Age=31536000`;
  location.reload();
}

(function () {
  const silence = 4000, slept = 10000; // ms without the beat of the server, which comes every second
  const parts = ".gm-head, .gm-nav, .gm-main, .q-dialog, .q-menu";
  let beat = "", quiet = 0, last = Date.now(), left = null;

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

  // whoever comes back to the page must hear the server first
  document.addEventListener("visibilitychange", () => { if (!document.hidden) quiet = silence + 1; });

  setInterval(() => {
    // a browser that was busy for some seconds has heard nothing in that time, whatever the server said; one that slept
    // knows nothing
    const passed = Math.max(0, Date.now() - last);
    last = Date.now();
    quiet += passed > slept ? silence + 1 : Math.min(passed, 1000);
    const now = document.querySelector(".gm-beat")?.textContent ?? "";
    if (now !== beat) {
      beat = now;
      quiet = 0;
    }
    const began = window.did_handshake === true, connected = began && window.socket.connected;
    const silent = quiet > silence;
    document.body.classList.toggle("gm-is-lost", silent || (began && !connected));
    document.body.classList.toggle("gm-is-live", connected && !silent);
    open(connected && !silent);
  }, 100);
})();
