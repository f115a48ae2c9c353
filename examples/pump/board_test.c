/* The board of a test: the button and the pump are lines of JSON on the standard streams. */
#include "board.h"

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static int button;
static long start;

long board_millis(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return time.tv_sec * 1000L + time.tv_nsec / 1000000L;
}

void board_open(void) {
    setvbuf(stdin, NULL, _IONBF, 0); /* poll does not see what waits in a buffer */
    setvbuf(stdout, NULL, _IOLBF, 0);
    puts("{\"event\": \"ready\"}");
    start = board_millis();
    if (getenv("RECORD")) fputs("time [ms],event,down,on\n", stderr);
}

int board_button(void) {
    struct pollfd input = {0, POLLIN, 0};
    char line[256];

    while (poll(&input, 1, 0) > 0) {
        if (fgets(line, sizeof line, stdin) == NULL) exit(0); /* the test is over */
        button = strstr(line, "\"down\": 1") != NULL;
        if (getenv("RECORD")) fprintf(stderr, "%ld,button,%d,\n", board_millis() - start, button);
    }
    return button;
}

void board_pump(int on) {
    printf("{\"event\": \"pump\", \"on\": %d}\n", on);
    if (getenv("RECORD")) fprintf(stderr, "%ld,pump,,%d\n", board_millis() - start, on);
}

void board_sleep(long millis) { poll(NULL, 0, (int)millis); }
