/* An adapter of a C program for `tachk test --adapter process:COMMAND`: events as lines of JSON on the standard streams.

   Copy this file beside your program and include it in one C file.

   tachk_begin();                                        the program is ready, the model starts
   tachk_output("heater", "\"on\": %d", on);             an output with its columns, at once; "" for none
   tachk_input(line, sizeof line, milliseconds)          waits for an input: 1 there is one, 0 none in that time,
                                                         -1 the test is over; -1 milliseconds wait for ever
   tachk_is(line, "reading")                             whether it is that event
   tachk_column(line, "cold", 0)                         the number in a column; the last argument if it has none

   Reads stdin by itself: use no other reader of it. A line that is longer than the buffer is dropped whole. */
#ifndef TACHK_ADAPTER_H
#define TACHK_ADAPTER_H

#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static char tachk_text[4096];
static size_t tachk_length;

static void tachk_output(const char *event, const char *columns, ...) {
    va_list values;
    printf("{\"event\": \"%s\"%s", event, *columns ? ", " : "");
    va_start(values, columns);
    vprintf(columns, values);
    va_end(values);
    puts("}");
    fflush(stdout);
}

static void tachk_begin(void) { tachk_output("ready", ""); }

static long tachk_milliseconds(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return time.tv_sec * 1000L + time.tv_nsec / 1000000L;
}

static int tachk_input(char *line, size_t size, int milliseconds) {
    long last = tachk_milliseconds() + milliseconds;
    for (;;) {
        struct pollfd input = {STDIN_FILENO, POLLIN, 0};
        char *end = memchr(tachk_text, '\n', tachk_length);
        long left = milliseconds < 0 ? -1 : last - tachk_milliseconds();
        ssize_t count;
        if (end != NULL) {
            size_t used = (size_t)(end + 1 - tachk_text);
            int fits = used <= size;
            if (fits) memcpy(line, tachk_text, used), line[used - 1] = '\0';
            memmove(tachk_text, tachk_text + used, tachk_length -= used);
            if (fits) return 1;
            continue;
        }
        if (tachk_length == sizeof tachk_text) tachk_length = 0;
        if (milliseconds >= 0 && left < 0) left = 0;
        if (poll(&input, 1, (int)left) == 0) return 0;
        count = read(STDIN_FILENO, tachk_text + tachk_length, sizeof tachk_text - tachk_length);
        if (count <= 0) return -1;
        tachk_length += (size_t)count;
    }
}

/* What stands behind "name": in a line; NULL if it has no such column. */
static const char *tachk_value(const char *line, const char *name) {
    size_t length = strlen(name);
    const char *place = line;
    while ((place = strchr(place, '"')) != NULL) {
        if (strncmp(++place, name, length) == 0 && place[length] == '"' && place[length + 1] == ':')
            return place + length + 2 + strspn(place + length + 2, " ");
    }
    return NULL;
}

static long tachk_column(const char *line, const char *name, long otherwise) {
    const char *value = tachk_value(line, name);
    if (value == NULL || strncmp(value, "null", 4) == 0) return otherwise;
    if (strncmp(value, "true", 4) == 0) return 1;
    return strtol(value, NULL, 10);
}

static int tachk_is(const char *line, const char *event) {
    const char *value = tachk_value(line, "event");
    size_t length = strlen(event);
    return value != NULL && *value == '"' && strncmp(value + 1, event, length) == 0 && value[length + 1] == '"';
}

#endif
