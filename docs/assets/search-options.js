// `--max-states` in the search field is the name of an option. The search of the theme would take the dashes for
// "without this word", and find nothing.
(() => {
  const QUERY = 2
  const send = Worker.prototype.postMessage
  Worker.prototype.postMessage = function (message, ...others) {
    if (message?.type === QUERY && typeof message.data === "string")
      message = { ...message, data: message.data.replace(/(^|[\s+])(?:--+|-(?=\w\b))/g, "$1") }
    return send.call(this, message, ...others)
  }
})()
