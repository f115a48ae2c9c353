"""The report that one can hand on: a page with answers, runs to step through, and pictures. `content` says what is on
it, `playback` what its script needs to step through a run, and `html` writes it."""
