/* Controller of a garden pump with one push button.

   A press starts the pump, the next press stops it. The button bounces: a change of the pin counts when the pin has not
   changed for 50 ms. The pump stops by itself after 2 s, since it must not run dry. Then it rests for 500 ms: presses
   in that time do nothing.

   cc -o pump pump.c board_gpio.c            the controller on its board
   cc -o pump pump.c board_test.c            under test, by the clock of the wall
   cc -o pump pump.c board_driven.c          under test, with a clock that the test moves on
   cc -DFAULT -o pump pump.c board_test.c    with a fault: a bounce does not start the 50 ms again */
#include "board.h"

enum { DEBOUNCE = 50, LONGEST = 2000, REST = 500, PERIOD = 5 }; /* ms */

typedef struct {
    int raw, down; /* what the pin says, and the debounced button */
    long since;    /* the last change of the pin */
} Button;

/* Whether the button was pressed just now. */
static int pressed(Button *button, int raw, long now) {
    if (raw != button->raw) {
        button->raw = raw;
#ifdef FAULT
        if (now - button->since >= DEBOUNCE)
#endif
            button->since = now;
    }
    if (button->raw != button->down && now - button->since >= DEBOUNCE) {
        button->down = button->raw;
        return button->down;
    }
    return 0;
}

int main(void) {
    Button button = {0, 0, 0};
    int running = 0;
    long changed;

    board_open();
    changed = board_millis() - REST;
    for (;;) {
        long now = board_millis();
        int press = pressed(&button, board_button(), now);

        if (running && (press || now - changed >= LONGEST)) {
            board_pump(running = 0);
            changed = now;
        } else if (!running && press && now - changed >= REST) {
            board_pump(running = 1);
            changed = now;
        }
        board_sleep(PERIOD);
    }
}
