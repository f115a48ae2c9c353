/* The hardware that the controller sees. */
void board_open(void);
long board_millis(void);      /* since some moment */
int board_button(void);       /* whether the pin of the button says that it is down */
void board_pump(int on);      /* switches the relay */
void board_sleep(long millis);
