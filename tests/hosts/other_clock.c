// A clock that is wrong, for all programs of one container: preloaded (ld.so.preload(5)), since the kernel has one clock
// for all containers and lets none of them set it. The difference, in ns, lies in a file that everybody maps; setting or
// stepping the clock, as chronyd does, changes that file alone.
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/timex.h>
#include <time.h>
#include <unistd.h>

static const long long second = 1000000000LL;

static volatile long long *difference(void) {
  static long long none, *place;
  if (!place) {
    int error = errno, file = open("/run/other-clock", O_RDWR | O_CLOEXEC), writes = file >= 0;
    if (!writes) file = open("/run/other-clock", O_RDONLY | O_CLOEXEC);
    void *found = file < 0 ? MAP_FAILED : mmap(NULL, sizeof none, PROT_READ | (writes ? PROT_WRITE : 0), MAP_SHARED, file, 0);
    if (file >= 0) close(file);
    place = found == MAP_FAILED ? &none : found;
    errno = error;
  }
  return place;
}

static long long now(void) {
  struct timespec t;
  syscall(SYS_clock_gettime, CLOCK_REALTIME, &t);
  return t.tv_sec * second + t.tv_nsec + *difference();
}

int clock_gettime(clockid_t id, struct timespec *t) {
  if (id != CLOCK_REALTIME && id != CLOCK_REALTIME_COARSE) return syscall(SYS_clock_gettime, id, t);
  long long value = now();
  t->tv_sec = value / second;
  t->tv_nsec = value % second;
  return 0;
}

int gettimeofday(struct timeval *t, void *zone) {
  long long value = now();
  t->tv_sec = value / second;
  t->tv_usec = value % second / 1000;
  return 0;
}

time_t time(time_t *t) {
  time_t value = now() / second;
  if (t) *t = value;
  return value;
}

int clock_settime(clockid_t id, const struct timespec *t) {
  *difference() += t->tv_sec * second + t->tv_nsec - now();
  return 0;
}

int settimeofday(const struct timeval *t, const struct timezone *zone) {
  if (t) *difference() += t->tv_sec * second + t->tv_usec * 1000 - now();
  return 0;
}

int clock_adjtime(clockid_t id, struct timex *x) {
  static long frequency, tick = 10000;
  if (x->modes & ADJ_FREQUENCY) frequency = x->freq;
  if (x->modes & ADJ_TICK) tick = x->tick;
  if (x->modes & ADJ_SETOFFSET)
    *difference() += x->time.tv_sec * second + x->time.tv_usec * (x->modes & ADJ_NANO ? 1 : 1000);
  memset(x, 0, sizeof *x);
  x->freq = frequency;
  x->tick = tick;
  return TIME_OK;
}

int adjtimex(struct timex *x) { return clock_adjtime(CLOCK_REALTIME, x); }
int ntp_adjtime(struct timex *x) { return clock_adjtime(CLOCK_REALTIME, x); }

// Packets must not be stamped by the kernel, whose clock is another one.
int setsockopt(int file, int level, int name, const void *value, socklen_t length) {
  if (level == SOL_SOCKET && (name == SO_TIMESTAMP || name == SO_TIMESTAMPNS || name == SO_TIMESTAMPING)) {
    errno = ENOPROTOOPT;
    return -1;
  }
  return syscall(SYS_setsockopt, file, level, name, value, length);
}
