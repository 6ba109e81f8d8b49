// A page that was opened from a folder may not start a worker. There, and only there, what the search
// would do in a worker is done in a hidden frame, by the same messages.
if (location.protocol === "file:") {
  window.IFrameWorker = class extends EventTarget {
    constructor(script) {
      super();
      const frame = document.createElement("iframe");
      frame.hidden = true;
      frame.srcdoc =
        "<script>window.postMessage = (data) =>" +
        ' frameElement.dispatchEvent(new MessageEvent("answer", { data }));</script>' +
        `<script src="${new URL(script, document.baseURI)}"></script>`;
      this.loaded = new Promise((done) => frame.addEventListener("load", done));
      frame.addEventListener("answer", ({ data }) => {
        const event = new MessageEvent("message", { data });
        this.dispatchEvent(event);
        if (this.onmessage) this.onmessage(event);
      });
      this.frame = frame;
      document.body.append(frame);
    }

    async postMessage(data) {
      await this.loaded;
      this.frame.contentWindow.dispatchEvent(new MessageEvent("message", { data }));
    }

    terminate() {
      this.frame.remove();
    }
  };
  window.Worker = window.IFrameWorker;
}
