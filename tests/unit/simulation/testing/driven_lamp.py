"""A program whose clock is driven: a lamp that goes on so many units after each press (the first argument)."""

import json
import sys


def answer(**row: object) -> None:
    sys.stdout.write(json.dumps(row) + "\n")
    sys.stdout.flush()


def main() -> None:
    delay, due = float(sys.argv[1]), None
    answer(event="ready")
    for line in sys.stdin:
        row = json.loads(line)
        if "event" in row:
            due = row["time"] + delay if due is None else due
        elif due is not None and due <= row["until"]:
            answer(time=due, event="light")
            due = None
        else:
            answer(time=row["until"])


if __name__ == "__main__":
    main()
