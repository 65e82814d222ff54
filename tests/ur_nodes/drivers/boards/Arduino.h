// As much of Arduino's interface as the sketch ur_base needs, on a computer: two motors with encoders, and a line that is
// standard input and output. Each line of standard input: ms, at which its bytes (hexadecimal) arrive.
#pragma once
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

enum { INPUT_PULLUP, OUTPUT, CHANGE };
static const double FULL_SPEED = 1800;  // counts a second
static unsigned long now_ms = 0;
static int levels[64], powers[64];
static void (*interrupts_of[64])();
static double places[2];

inline unsigned long millis() { return now_ms; }
inline void pinMode(int, int) {}
inline int digitalRead(int pin) { return levels[pin]; }
inline void digitalWrite(int pin, int level) { levels[pin] = level; }
inline void analogWrite(int pin, int power) { powers[pin] = power; }
inline int analogRead(int) { return 0; }
inline int digitalPinToInterrupt(int pin) { return pin; }
inline void attachInterrupt(int pin, void (*call)(), int) { interrupts_of[pin] = call; }
inline void noInterrupts() {}
inline void interrupts() {}

struct {
  std::string waiting;
  void begin(long) {}
  int available() { return (int)waiting.size(); }
  int read() {
    const char byte = waiting[0];
    waiting.erase(0, 1);
    return (unsigned char)byte;
  }
  void print(const char *text) { fputs(text, stdout); }
} Serial;
