/* The board of a test that moves the clock on: hours take seconds, and a test is the same each time. */
#include "board.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int button, asked; /* asked: the test waits for an answer */
static double now, until; /* ms; the test lets the clock go on until then */

/* Does what the test says, until the clock may go on. */
static void obey(void) {
    char line[256], *found;

    while (!asked || until <= now) {
        if (asked) printf("{\"time\": %.17g}\n", until);
        asked = 0;
        if (fgets(line, sizeof line, stdin) == NULL) exit(0); /* the test is over */
        if ((found = strstr(line, "\"until\": ")) != NULL) {
            until = atof(found + strlen("\"until\": "));
            asked = 1;
        } else {
            button = strstr(line, "\"down\": 1") != NULL;
        }
    }
}

void board_open(void) {
    setvbuf(stdout, NULL, _IOLBF, 0);
    puts("{\"event\": \"ready\"}");
}

long board_millis(void) { return (long)now; }

int board_button(void) { return button; }

void board_pump(int on) {
    printf("{\"time\": %.17g, \"event\": \"pump\", \"on\": %d}\n", now, on);
    asked = 0; /* the clock stays there */
}

void board_sleep(long millis) {
    double end = now + millis;

    for (obey(); until < end; obey()) now = until;
    now = end;
}
