// A worker in a hidden frame, for pages that are opened from a folder: browsers start no real workers there. The search
// of the theme needs one. What the worker calls is what the search calls: importScripts, postMessage and "message".
(() => {
  if (location.protocol !== "file:") return

  function runInFrame(parentOrigin, url) {
    self.postMessage = data => parent.postMessage({ frameWorker: url, data }, parentOrigin)
    self.importScripts = (...urls) =>
      urls.reduce((before, each) => before.then(() => new Promise((resolve, reject) => {
        const script = document.createElement("script")
        Object.assign(script, { src: each, onload: resolve, onerror: reject })
        document.body.appendChild(script)
      })), Promise.resolve())
  }

  window.Worker = class extends EventTarget {
    constructor(url) {
      super()
      this.url = `${url}`
      this.frame = Object.assign(document.createElement("iframe"), { hidden: true })
      document.body.appendChild(this.frame)
      this.listener = event => {
        if (event.source !== this.frame.contentWindow || event.data?.frameWorker !== this.url) return
        const message = new MessageEvent("message", { data: event.data.data })
        this.dispatchEvent(message)
        this.onmessage?.(message)
      }
      addEventListener("message", this.listener)
      const page = this.frame.contentDocument
      page.open()
      page.write(`<html><body><script>(${runInFrame})("*", ${JSON.stringify(this.url)})<\/script>` +
        `<script src="${this.url}"><\/script></body></html>`)
      page.close()
      this.ready = new Promise(resolve => this.frame.contentWindow.addEventListener("load", resolve))
    }

    postMessage(data) {
      this.ready.then(() =>
        this.frame.contentWindow.dispatchEvent(new MessageEvent("message", { data: structuredClone(data) })))
    }

    terminate() {
      removeEventListener("message", this.listener)
      this.frame.remove()
    }
  }
})()
