// The WebSocket to the server, which is opened again where it breaks.

/** From one try to the next, ms: the first and the longest. */
const RETRY = [500, 5000];

export class Connection {
  /**
   * @param {{binary: function(ArrayBuffer), text: function(Object), status: function(string)}} handlers
   *   `status` is told "connecting", "open" or "closed"
   * @param {function(): boolean} isOver whether nothing more is to come
   */
  constructor(handlers, isOver) {
    this.handlers = handlers;
    this.isOver = isOver;
    this.retry = RETRY[0];
    this.open();
  }

  open() {
    this.handlers.status("connecting");
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const socket = new WebSocket(`${scheme}://${location.host}/live`);
    socket.binaryType = "arraybuffer";
    socket.addEventListener("open", () => {
      this.retry = RETRY[0];
      this.handlers.status("open");
    });
    socket.addEventListener("message", ({ data }) => {
      if (typeof data === "string") {
        this.handlers.text(JSON.parse(data));
      } else {
        this.handlers.binary(data);
      }
    });
    socket.addEventListener("close", () => {
      this.handlers.status("closed");
      // What has come of a test that is over stays: another one at this address would take its place.
      if (!this.isOver()) {
        setTimeout(() => this.open(), this.retry);
        this.retry = Math.min(2 * this.retry, RETRY[1]);
      }
    });
  }
}
