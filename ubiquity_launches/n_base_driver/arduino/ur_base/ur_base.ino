// The sketch of a base with two wheels: flash it, and give the base `driver: arduino`.
//
// Expected: an Arduino with two interrupts (Uno, Nano, Mega, ...), two encoders with two channels, and a driver of motors
// with a direction and a power for each (L298N, TB6612, DRV8833, ...). Set the constants below to your wires.
// The motors stop 150 ms after the last command, and when the switch at STOP_PIN opens.
#include "protocol.h"

const int LEFT_A = 2, RIGHT_A = 3;        // the pins with interrupts of an Uno
const int LEFT_B = 4, RIGHT_B = 7;
const int LEFT_POWER = 5, RIGHT_POWER = 6;  // PWM
const int LEFT_FORWARD = 8, LEFT_BACKWARD = 9, RIGHT_FORWARD = 10, RIGHT_BACKWARD = 11;
const int BUMPER_PINS[3] = {-1, -1, -1};  // left, right, front: a switch to ground; -1: there is none
const int STOP_PIN = -1;                  // an emergency stop that opens: a switch to ground; -1: there is none
const int BATTERY_PIN = -1;               // the middle of a divider; -1: there is none
const float MILLIVOLT = 5000.0 / 1023 * (10 + 3.3) / 3.3;  // of the battery, for each step of the converter
const bool LEFT_TURNED = false, RIGHT_TURNED = false;      // a motor and its encoder are mounted the other way round
const float FASTEST = 2000;               // counts a second at full power
const float SHARE = 0.5, MEMORY = 4.0;    // how hard an error, and one that stays, is corrected

volatile long counted_left = 0, counted_right = 0;
ur::Reader reader;
ur::Wheel left_wheel(FASTEST, SHARE, MEMORY), right_wheel(FASTEST, SHARE, MEMORY);
long wanted_left = 0, wanted_right = 0;
unsigned long commanded = 0, reported = 0;

void count_left() { counted_left += (digitalRead(LEFT_A) == digitalRead(LEFT_B)) != LEFT_TURNED ? -1 : 1; }
void count_right() { counted_right += (digitalRead(RIGHT_A) == digitalRead(RIGHT_B)) != RIGHT_TURNED ? -1 : 1; }

void turn(int forward, int backward, int pin, int power) {
  digitalWrite(forward, power > 0);
  digitalWrite(backward, power < 0);
  analogWrite(pin, power < 0 ? -power : power);
}

void setup() {
  Serial.begin(115200);
  const int inputs[] = {LEFT_A, LEFT_B, RIGHT_A, RIGHT_B, BUMPER_PINS[0], BUMPER_PINS[1], BUMPER_PINS[2], STOP_PIN};
  for (int pin : inputs)
    if (pin >= 0) pinMode(pin, INPUT_PULLUP);
  const int outputs[] = {LEFT_FORWARD, LEFT_BACKWARD, RIGHT_FORWARD, RIGHT_BACKWARD, LEFT_POWER, RIGHT_POWER};
  for (int pin : outputs) pinMode(pin, OUTPUT);
  attachInterrupt(digitalPinToInterrupt(LEFT_A), count_left, CHANGE);
  attachInterrupt(digitalPinToInterrupt(RIGHT_A), count_right, CHANGE);
}

void loop() {
  char text[64];
  while (Serial.available()) {
    const ur::Kind kind = reader.take((char)Serial.read());
    if (kind == ur::SPEEDS) {
      wanted_left = reader.left;
      wanted_right = reader.right;
      commanded = millis();
    } else if (kind == ur::QUESTION) {
      strcpy(text, "h ur-base 1 sketch of ubiquity_launches");
      ur::seal(text);
      Serial.print(text);
    }
  }
  const unsigned long now = millis();
  const bool stopped = STOP_PIN >= 0 && digitalRead(STOP_PIN);
  if (now - commanded > ur::WATCHDOG || stopped) wanted_left = wanted_right = 0;
  if (wanted_left == 0) turn(LEFT_FORWARD, LEFT_BACKWARD, LEFT_POWER, 0);
  if (wanted_right == 0) turn(RIGHT_FORWARD, RIGHT_BACKWARD, RIGHT_POWER, 0);
  if (now - reported < 20) return;
  const float seconds = (now - reported) / 1000.0;
  reported = now;
  noInterrupts();
  const long left = counted_left, right = counted_right;
  interrupts();
  const int left_power = left_wheel.update(wanted_left, left, seconds);
  const int right_power = right_wheel.update(wanted_right, right, seconds);
  turn(LEFT_FORWARD, LEFT_BACKWARD, LEFT_POWER, LEFT_TURNED ? -left_power : left_power);
  turn(RIGHT_FORWARD, RIGHT_BACKWARD, RIGHT_POWER, RIGHT_TURNED ? -right_power : right_power);
  unsigned flags = stopped ? ur::NO_POWER : 0;
  for (int k = 0; k < 3; ++k)
    if (BUMPER_PINS[k] >= 0 && !digitalRead(BUMPER_PINS[k])) flags |= ur::BUMPER_LEFT << k;
  const long millivolt = BATTERY_PIN >= 0 ? (long)(analogRead(BATTERY_PIN) * MILLIVOLT) : 0;
  sprintf(text, "e %ld %ld %ld %u", left, right, millivolt, flags);
  ur::seal(text);
  Serial.print(text);
}
