// The lines of the protocol ur-base 1, and the control of a wheel's speed. Plain C++, without a board.
//
// A line ends with a newline, and before it with `*` and two hexadecimal digits: the exclusive or of all bytes before
// the `*`. The board takes `v LEFT RIGHT` (counts a second) and `?`, and sends `h ur-base 1 TEXT` as the answer to the
// question and, 50 times a second, `e LEFT RIGHT MILLIVOLT FLAGS`: the counters of the wheels, which wrap at 32 bits.
#pragma once
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

namespace ur {

const unsigned long WATCHDOG = 150;  // ms after the last command, at which the motors stop
const uint8_t NO_POWER = 1, BUMPER_LEFT = 2, BUMPER_RIGHT = 4, BUMPER_FRONT = 8;

inline uint8_t checksum(const char *text) {
  uint8_t sum = 0;
  for (; *text; ++text) sum ^= (uint8_t)*text;
  return sum;
}

// A line with its checksum, in a buffer of at least 8 bytes more than the text has.
inline void seal(char *text) {
  const uint8_t sum = checksum(text);
  sprintf(text + strlen(text), "*%02X\r\n", sum);
}

enum Kind { NOTHING, SPEEDS, QUESTION };

// Collects bytes; a line that is too long, damaged or no command is left out.
class Reader {
 public:
  long left = 0, right = 0;  // of the last SPEEDS

  Kind take(char byte) {
    if (byte != '\n') {
      if (size_ < sizeof line_ - 1) line_[size_] = byte;
      if (size_ < sizeof line_) ++size_;
      return NOTHING;
    }
    const bool fits = size_ < sizeof line_;
    line_[fits ? size_ : 0] = 0;
    size_ = 0;
    return fits ? read() : NOTHING;
  }

 private:
  char line_[48];
  uint8_t size_ = 0;

  Kind read() {
    char *star = strrchr(line_, '*');
    if (!star) return NOTHING;
    *star = 0;
    char *end;
    const long sum = strtol(star + 1, &end, 16);
    if (end != star + 3 || sum != checksum(line_)) return NOTHING;
    if (!strcmp(line_, "?")) return QUESTION;
    if (strncmp(line_, "v ", 2)) return NOTHING;
    const long first = strtol(line_ + 2, &end, 10);
    if (end == line_ + 2 || *end != ' ') return NOTHING;
    char *rest = end;
    const long second = strtol(rest, &end, 10);
    if (end == rest || *end) return NOTHING;
    left = first;
    right = second;
    return SPEEDS;
  }
};

// The power (-255 to 255) that turns a wheel at a speed: a share of it by the wanted speed alone, the rest by its error.
class Wheel {
 public:
  Wheel(float fastest, float share, float memory) : fastest_(fastest), share_(share), memory_(memory) {}

  int update(long wanted, long count, float seconds) {
    const float speed = (int32_t)((uint32_t)count - (uint32_t)last_) / seconds;
    last_ = count;
    if (wanted == 0) {
      sum_ = 0;
      return 0;
    }
    const float error = wanted - speed;
    sum_ += error * seconds;
    const float most = fastest_ / memory_;
    sum_ = sum_ > most ? most : sum_ < -most ? -most : sum_;
    const float power = 255 * (wanted + share_ * error + memory_ * sum_) / fastest_;
    return power > 255 ? 255 : power < -255 ? -255 : (int)power;
  }

 private:
  const float fastest_, share_, memory_;
  float sum_ = 0;
  long last_ = 0;
};

}  // namespace ur
