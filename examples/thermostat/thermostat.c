/* A thermostat that reads whether the room is cold, and switches a heater, as JSON lines on the standard streams.

   cc -o thermostat thermostat.c            the thermostat
   cc -DFAULT -o thermostat thermostat.c    it measures the rest of the heater from when it went on, not off */
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { REST = 500 };

static long now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return time.tv_sec * 1000L + time.tv_nsec / 1000000L;
}

static void heater(int on) { printf("{\"event\": \"heater\", \"on\": %d}\n", on); }

int main(void) {
    static char text[4096];
    size_t length = 0;
    int cold = 0, on = 0;
    long rest = now() - REST; /* since when the heater rests */

    setvbuf(stdout, NULL, _IOLBF, 0);
    printf("{\"event\": \"ready\"}\n");
    for (;;) {
        struct pollfd input = {STDIN_FILENO, POLLIN, 0};
        long left = cold && !on ? rest + REST - now() : -1;
        char *end;

        if (cold && !on && left <= 0) {
            heater(on = 1);
#ifdef FAULT
            rest = now();
#endif
            continue;
        }
        if (poll(&input, 1, (int)left) > 0) {
            ssize_t count = read(STDIN_FILENO, text + length, sizeof text - 1 - length);
            if (count <= 0) return 0; /* the test is over */
            text[length += (size_t)count] = '\0';
            while ((end = strchr(text, '\n')) != NULL) {
                *end = '\0';
                cold = strstr(text, "\"cold\": 1") != NULL;
                length -= (size_t)(end + 1 - text);
                memmove(text, end + 1, length + 1);
            }
            if (!cold && on) {
                heater(on = 0);
#ifndef FAULT
                rest = now();
#endif
            }
        }
    }
}
