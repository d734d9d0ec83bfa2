// Firmware of the rig's motor controller, protocol version 1 (docs/rig/protocol.md).
//
// A sketch to start from, for any Arduino-like board with 16 kB of memory and a 32-bit processor.
// Yours to fill in: the three functions under "hardware". Its logic is that of
// src/softfinger/rig/device.py, which is tested; on a board of yours, test it first with the wire
// off the finger: pull the USB cable in mid-trial, stop the recorder with kill -9, hang a weight
// beyond the limit on the load cell. Each time the motor must go slack by itself.
//
// Also arm the processor's own watchdog and give the motor driver a pull-down on its enable pin, so
// that a crashed or unpowered board lets the wire go too.

#include <Arduino.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

const int32_t HARD_LIMIT_MN = 20000;  // the recorder may set a lower one, never a higher one
const uint32_t WATCHDOG_US = 1000000;
const int MAX_KNOTS = 512;
const int32_t MAX_RATE_HZ = 500;
const int MAX_LINE = 200;
const int ENABLE_PIN = 4, MOTOR_PIN = 5, LIGHT_PIN = 6, TENSION_PIN = A0, CURRENT_PIN = A1;

// ---- hardware -----------------------------------------------------------------------------------

int32_t read_tension_mn() { return (analogRead(TENSION_PIN) - 512) * 40L; }  // calibrate

int32_t read_current_ma() { return analogRead(CURRENT_PIN) * 2L; }  // calibrate

void drive_motor(int32_t wanted_mn, int32_t measured_mn) {  // tune; 0 wanted means slack
  static int32_t sum = 0;
  digitalWrite(ENABLE_PIN, wanted_mn > 0 ? HIGH : LOW);
  sum = wanted_mn > 0 ? constrain(sum + (wanted_mn - measured_mn) / 8, -200000L, 200000L) : 0;
  int32_t level = wanted_mn / 100 + (wanted_mn - measured_mn) / 50 + sum / 2000;
  analogWrite(MOTOR_PIN, wanted_mn > 0 ? constrain(level, 0L, 255L) : 0);
}

// ---- state --------------------------------------------------------------------------------------

enum State { IDLE, ARMED, RUNNING, HOLDING };

State state = IDLE;
int32_t limit_mn = HARD_LIMIT_MN;
uint32_t knot_us[MAX_KNOTS];
int32_t knot_mn[MAX_KNOTS];
int knots = 0, reached = 0;
int32_t held_mn = 0;
uint64_t started_us = 0, fed_us = 0;

uint64_t sample_interval_us = 0, next_sample_us = 0;  // interval 0: no samples
uint32_t sample_number = 0;

int edges = 0, edges_done = 0;
uint64_t next_edge_us = 0;
uint32_t half_us = 0;

uint64_t now_us() {  // micros() starts again after 71 minutes
  static uint32_t last = 0;
  static uint64_t turns = 0;
  uint32_t now = micros();
  if (now < last) turns += (uint64_t)1 << 32;
  last = now;
  return turns + now;
}

// ---- lines --------------------------------------------------------------------------------------

char out[MAX_LINE];
int out_size = 0;

uint16_t checksum(const char* text, int size) {  // CRC-16/CCITT-FALSE
  uint16_t crc = 0xFFFF;
  for (int i = 0; i < size; i++) {
    crc ^= (uint16_t)(uint8_t)text[i] << 8;
    for (int bit = 0; bit < 8; bit++) crc = crc & 0x8000 ? (crc << 1) ^ 0x1021 : crc << 1;
  }
  return crc;
}

void put(const char* text) {
  while (*text && out_size < MAX_LINE - 8) out[out_size++] = *text++;
}

void put_number(int64_t value) {
  char digits[24];
  int at = sizeof digits - 1;
  uint64_t rest = value < 0 ? -value : value;
  digits[at] = 0;
  do digits[--at] = '0' + rest % 10; while (rest /= 10);
  if (value < 0) digits[--at] = '-';
  put(digits + at);
}

void put_field(const char* key, int64_t value) {
  put(" ");
  put(key);
  put("=");
  put_number(value);
}

void begin_line(int64_t number, const char* verb) {
  out_size = 0;
  put_number(number);
  put(" ");
  put(verb);
}

void end_line() {
  const char* hex = "0123456789ABCDEF";
  uint16_t crc = checksum(out, out_size);
  out[out_size++] = '*';
  for (int shift = 12; shift >= 0; shift -= 4) out[out_size++] = hex[(crc >> shift) & 15];
  out[out_size++] = '\n';
  Serial.write((const uint8_t*)out, out_size);
}

void begin_event(const char* name, uint64_t when) {
  begin_line(0, "event");
  put(" name=");
  put(name);
  put_field("t_us", when);
}

// ---- what it does all the time ------------------------------------------------------------------

void release(uint64_t now, const char* reason) {
  drive_motor(0, 0);
  if (state == IDLE) return;
  state = IDLE;
  begin_event("released", now);
  put(" reason=");
  put(reason);
  end_line();
}

int32_t wanted_mn(uint64_t now) {
  if (state == HOLDING) return held_mn;
  if (state != RUNNING) return 0;
  uint64_t since = now - started_us;
  while (reached + 1 < knots && knot_us[reached + 1] <= since) reached++;
  if (reached + 1 == knots) return knot_mn[reached];
  int64_t rise = knot_mn[reached + 1] - knot_mn[reached];
  int64_t step = knot_us[reached + 1] - knot_us[reached];
  return knot_mn[reached] + rise * (int64_t)(since - knot_us[reached]) / step;
}

void flash(uint64_t now) {
  if (edges_done == edges || now < next_edge_us) return;
  bool on = edges_done % 2 == 0;
  digitalWrite(LIGHT_PIN, on ? HIGH : LOW);
  begin_event("light", now);
  put_field("on", on);
  end_line();
  edges_done++;
  next_edge_us += half_us;
}

void sample(uint64_t now, int32_t measured_mn) {
  if (!sample_interval_us || now < next_sample_us) return;
  begin_line(0, "sample");
  put_field("n", sample_number++);
  put_field("t_us", now);
  put_field("tension_mn", measured_mn);
  put_field("current_ma", read_current_ma());
  end_line();
  next_sample_us += sample_interval_us;
}

void advance() {
  uint64_t now = now_us();
  int32_t measured = read_tension_mn();
  if (state == RUNNING && now - started_us >= knot_us[knots - 1]) {
    held_mn = knot_mn[knots - 1];
    state = HOLDING;
    sample(now, measured);
    begin_event("finished", started_us + knot_us[knots - 1]);
    end_line();
  }
  drive_motor(wanted_mn(now), measured);
  flash(now);
  sample(now, measured);
  if ((state == RUNNING || state == HOLDING) && measured > limit_mn) release(now, "limit");
  if (state != IDLE && now - fed_us > WATCHDOG_US) {
    release(now, "heartbeat");
    sample_interval_us = 0;
  }
}

// ---- requests -----------------------------------------------------------------------------------

int64_t request = 0;

void begin_ok() {
  begin_line(request, "ok");
  put_field("t_us", now_us());
}

void accept() {
  begin_ok();
  end_line();
}

void refuse(const char* why) {
  begin_line(request, "error");
  put(" why=");
  put(why);
  end_line();
}

bool find_number(const char* fields, const char* key, int64_t* value) {
  size_t size = strlen(key);
  for (const char* at = fields; at; at = strchr(at, ' ')) {
    while (*at == ' ') at++;
    if (strncmp(at, key, size) == 0 && at[size] == '=') {
      char* end;
      *value = strtoll(at + size + 1, &end, 10);
      return end != at + size + 1 && (*end == ' ' || *end == 0);
    }
  }
  return false;
}

void hello() {
  release(now_us(), "request");
  sample_interval_us = 0;
  limit_mn = HARD_LIMIT_MN;
  begin_ok();
  put_field("version", 1);
  put(" device=softfinger-rig firmware=1.0");
  put_field("simulated", 0);
  put_field("limit_mn", HARD_LIMIT_MN);
  put_field("max_knots", MAX_KNOTS);
  put_field("max_rate_hz", MAX_RATE_HZ);
  put_field("watchdog_ms", WATCHDOG_US / 1000);
  end_line();
}

void add_knot(const char* fields) {
  int64_t i, t_us, tension;
  if (!find_number(fields, "i", &i) || !find_number(fields, "t_us", &t_us) ||
      !find_number(fields, "tension_mn", &tension))
    return refuse("bad_field");
  if (i != knots || knots == MAX_KNOTS) return refuse("wrong_number_of_knot");
  if (t_us < (knots ? knot_us[knots - 1] : 0) || t_us > UINT32_MAX)
    return refuse("time_runs_backwards");
  if (tension < 0 || tension > limit_mn) return refuse("tension_beyond_limit");
  knot_us[knots] = t_us;
  knot_mn[knots++] = tension;
  accept();
}

void start_light(const char* fields) {
  int64_t flashes, half;
  if (!find_number(fields, "flashes", &flashes) || !find_number(fields, "half_us", &half))
    return refuse("bad_field");
  edges = 2 * flashes;
  edges_done = 0;
  half_us = half;
  next_edge_us = now_us() + half_us;
  accept();
}

void stream(const char* fields) {
  int64_t rate;
  if (!find_number(fields, "rate_hz", &rate)) return refuse("bad_field");
  if (rate < 0 || rate > MAX_RATE_HZ) return refuse("rate_out_of_range");
  sample_interval_us = rate ? 1000000 / rate : 0;
  sample_number = 0;
  next_sample_us = now_us();
  accept();
}

void require_idle_then(const char* verb, const char* fields) {
  int64_t value;
  if (state != IDLE) return refuse("not_while_motor_is_on");
  if (!strcmp(verb, "clear")) {
    knots = 0;
    return accept();
  }
  if (!strcmp(verb, "knot")) return add_knot(fields);
  if (!strcmp(verb, "sync")) return start_light(fields);
  if (!strcmp(verb, "limit")) {
    if (!find_number(fields, "tension_mn", &value)) return refuse("bad_field");
    if (value <= 0 || value > HARD_LIMIT_MN) return refuse("beyond_this_controller");
    limit_mn = value;
    return accept();
  }
  if (!find_number(fields, "knots", &value)) return refuse("bad_field");  // arm
  if (!knots || value != knots) return refuse("profile_is_not_whole");
  state = ARMED;
  accept();
}

void start() {
  if (state != ARMED) return refuse("not_armed");
  started_us = next_sample_us = now_us();  // a sample falls on the very start
  reached = 0;
  state = RUNNING;
  begin_line(request, "ok");
  put_field("t_us", started_us);
  end_line();
}

void stop() {
  if (state != RUNNING) return refuse("not_running");
  held_mn = wanted_mn(now_us());
  state = HOLDING;
  accept();
}

bool any_of(const char* verb, const char* const* verbs) {
  while (*verbs)
    if (!strcmp(verb, *verbs++)) return true;
  return false;
}

void obey(char* line) {
  static const char* const IDLE_VERBS[] = {"clear", "knot", "sync", "limit", "arm", 0};
  char* star = strrchr(line, '*');
  if (!star || strlen(star) != 5 || strtoul(star + 1, 0, 16) != checksum(line, star - line)) {
    begin_line(0, "error");
    put(" why=unreadable_line");
    return end_line();
  }
  *star = 0;
  char* verb;
  request = strtoll(line, &verb, 10);
  while (*verb == ' ') verb++;
  char* fields = strchr(verb, ' ');
  if (fields) *fields++ = 0;
  else fields = verb + strlen(verb);
  fed_us = now_us();
  if (!strcmp(verb, "release")) {
    release(now_us(), "request");
    accept();
  }
  else if (!strcmp(verb, "hello")) hello();
  else if (!strcmp(verb, "heartbeat")) accept();
  else if (!strcmp(verb, "environment")) accept();  // add sensors: put_field("humidity_pct", …)
  else if (!strcmp(verb, "stream")) stream(fields);
  else if (!strcmp(verb, "start")) start();
  else if (!strcmp(verb, "stop")) stop();
  else if (any_of(verb, IDLE_VERBS)) require_idle_then(verb, fields);
  else refuse("unknown_verb");
}

void listen() {
  static char line[MAX_LINE];
  static int size = 0;
  while (Serial.available()) {
    char c = Serial.read();
    if (c == '\n') {
      while (size && line[size - 1] == '\r') size--;
      line[size] = 0;
      if (size) obey(line);
      size = 0;
    } else if (size < MAX_LINE - 1) {
      line[size++] = c;
    }
  }
}

void setup() {
  pinMode(ENABLE_PIN, OUTPUT);
  pinMode(MOTOR_PIN, OUTPUT);
  pinMode(LIGHT_PIN, OUTPUT);
  drive_motor(0, 0);
  digitalWrite(LIGHT_PIN, LOW);
  Serial.begin(115200);
}

void loop() {
  listen();
  advance();
}
