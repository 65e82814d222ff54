// Run the sketch ur_base on a computer: see Arduino.h. At the end of each line of input the powers of both motors are printed.
#include "Arduino.h"
#include "ur_base.ino"

static void roll(int k, int a, int b, int forward, int backward, int power_pin) {
  const double power = powers[power_pin] / 255.0 * (levels[forward] - levels[backward]);
  const double before = places[k];
  places[k] += power * FULL_SPEED / 1000.0;
  for (long n = lround(before); n != lround(places[k]);) {
    const int step = places[k] > before ? 1 : -1;
    n += step;
    levels[a] = !levels[a];
    levels[b] = step > 0 ? !levels[a] : levels[a];
    interrupts_of[a]();
  }
}

int main() {
  setup();
  unsigned long until;
  char bytes[4096];
  while (scanf("%lu %4095s", &until, bytes) == 2) {
    for (; now_ms < until; ++now_ms) {
      roll(0, LEFT_A, LEFT_B, LEFT_FORWARD, LEFT_BACKWARD, LEFT_POWER);
      roll(1, RIGHT_A, RIGHT_B, RIGHT_FORWARD, RIGHT_BACKWARD, RIGHT_POWER);
      loop();
    }
    for (const char *at = bytes; at[0] && at[1] && *bytes != '-'; at += 2) {
      const char pair[3] = {at[0], at[1], 0};
      Serial.waiting += (char)strtol(pair, nullptr, 16);
    }
    loop();
    printf("motors %lu %d %d\n", now_ms, powers[LEFT_POWER] * (levels[LEFT_FORWARD] - levels[LEFT_BACKWARD]),
           powers[RIGHT_POWER] * (levels[RIGHT_FORWARD] - levels[RIGHT_BACKWARD]));
  }
}
