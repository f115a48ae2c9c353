/* The board: a pin for the button, one for the relay, through sysfs. */
#include "board.h"

#include <fcntl.h>
#include <time.h>
#include <unistd.h>

static int button, relay;

void board_open(void) {
    button = open("/sys/class/gpio/gpio17/value", O_RDONLY);
    relay = open("/sys/class/gpio/gpio27/value", O_WRONLY);
}

long board_millis(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return time.tv_sec * 1000L + time.tv_nsec / 1000000L;
}

int board_button(void) {
    char value = '0';
    pread(button, &value, 1, 0);
    return value == '1';
}

void board_pump(int on) { pwrite(relay, on ? "1" : "0", 1, 0); }

void board_sleep(long millis) {
    struct timespec time = {millis / 1000, millis % 1000 * 1000000};
    nanosleep(&time, NULL);
}
