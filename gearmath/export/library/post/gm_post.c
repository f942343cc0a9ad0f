/*
 * gm-post SETTINGS -o PROGRAM: the cutting program of a settings file that `gearmath export cnc SET.toml` wrote.
 *
 * The name of the program is that of its file, as with `gearmath nc cut`; so is its text, byte for byte. Status 0, or one
 * sentence and 2 where the settings file cannot be a program or its place cannot be written to, 1 where memory or disk
 * are full; then nothing is written.
 */
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "post.h"

enum { MOST_BYTES = 16 * 1024 * 1024, MOST_LETTERS = 24 };

/* What is taken back where the program ends early. */
static const char *unfinished;

static void stop(int status)
{
  if (unfinished) remove(unfinished);
  exit(status);
}

void refuse(const Job *job, int64_t line, const char *format, ...)
{
  va_list arguments;
  fprintf(stderr, "gm-post: %s: ", job->file);
  if (line) fprintf(stderr, "line %lld: ", (long long)line);
  va_start(arguments, format);
  vfprintf(stderr, format, arguments);
  va_end(arguments);
  fputc('\n', stderr);
  stop(2);
  abort(); /* not reached: stop does not return */
}

static void failed(const char *file, const char *why, int status)
{
  fprintf(stderr, "gm-post: %s: %s\n", file, why);
  stop(status);
}

void *grown(void *array, int64_t count, size_t size)
{
  void *larger = count <= INT64_MAX / 1024 ? realloc(array, (size_t)(count ? count : 1) * size) : NULL;
  if (!larger) failed("memory", "there is not enough", 1);
  return larger;
}

static char *contents(const char *file, size_t *length)
{
  FILE *stream = fopen(file, "rb");
  char *text = NULL;
  size_t room = 65536;
  if (!stream) failed(file, strerror(errno), 2);
  *length = 0;
  do {
    room *= 2;
    text = grown(text, (int64_t)room + 1, 1);
    *length += fread(text + *length, 1, room - *length, stream);
  } while (*length == room && room <= MOST_BYTES);
  if (ferror(stream)) failed(file, "cannot be read", 2);
  fclose(stream);
  if (*length > MOST_BYTES) failed(file, "is longer than 16 MB: this is no settings file of gm-post", 2);
  text[*length] = '\0';
  return text;
}

static int letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }

/* Whether an operating system keeps the name for itself: CON PRN AUX NUL COM1-9 LPT1-9, in any case. */
static int reserved(const char *name)
{
  static const char *const words[] = {"CON", "PRN", "AUX", "NUL", "COM", "LPT"};
  const size_t length = strlen(name);
  int k, j;
  for (k = 0; k < 6; ++k) {
    for (j = 0; j < 3 && (name[j] == words[k][j] || name[j] == words[k][j] + 32); ++j) {}
    if (j == 3 && (k < 4 ? length == 3 : length == 4 && name[3] >= '1' && name[3] <= '9')) return 1;
  }
  return 0;
}

/* The name of the program out of that of its file; controls take letters, digits and _ only. */
static void program_name(const char *file, char *name)
{
  const char *start = file, *at, *stop_at;
  size_t k, length;
  for (at = file; *at; ++at)
    if (*at == '/' || *at == '\\') start = at + 1;
  stop_at = strrchr(start, '.');
  length = stop_at && stop_at > start ? (size_t)(stop_at - start) : strlen(start);
  if (length > MOST_LETTERS) failed(file, "the name of the program has more than 24 characters", 2);
  memcpy(name, start, length);
  name[length] = '\0';
  for (k = 0; k < length; ++k)
    if (!letter(name[k]) && name[k] != '_' && !(name[k] >= '0' && name[k] <= '9')) break;
  if (k < length || length < 2 || !(letter(name[1]) && (letter(name[0]) || name[0] == '_')))
    failed(file, "the name of the program must be letters, digits and _, and begin with two letters or _ and a letter", 2);
  if (reserved(name)) failed(file, "the name of the program is a reserved name of the operating system", 2);
}

/* What stands where the program goes may be an older one, no folder or device, and no settings, whatever its name. */
static void check_place(const char *file)
{
  static const char head[] = "gm-post ";
  char begin[sizeof head];
  struct stat there;
  size_t count;
  FILE *stream;
  if (stat(file, &there) != 0) return;
  if (!S_ISREG(there.st_mode)) failed(file, "is a folder or a device, name a file for the program", 2);
  stream = fopen(file, "rb");
  if (!stream) return;
  count = fread(begin, 1, sizeof head - 1, stream);
  fclose(stream);
  if (count == sizeof head - 1 && memcmp(begin, head, count) == 0)
    failed(file, "is a settings file, name another for the program", 2);
}

int main(int count, char **arguments)
{
  Job job;
  char name[MOST_LETTERS + 1], *text, *aside;
  size_t length;
  FILE *stream;
  int64_t k;
  if (count != 4 || strcmp(arguments[2], "-o") != 0) failed("usage", "gm-post SETTINGS -o PROGRAM", 2);
  memset(&job, 0, sizeof job);
  job.file = arguments[1];
  program_name(arguments[3], name);
  check_place(arguments[3]);
  text = contents(arguments[1], &length);
  read_settings(&job, text, length);
  plan_passes(&job);
  /* whole or not at all: written beside its place first */
  aside = grown(NULL, (int64_t)strlen(arguments[3]) + 8, 1);
  sprintf(aside, "%s.part", arguments[3]);
  stream = fopen(aside, "wb");
  if (!stream) {
    const int why = errno;
    free(aside);
    failed(arguments[3], strerror(why), 2);
  }
  unfinished = aside;
  write_program(&job, name, stream);
  k = fflush(stream) != 0 || ferror(stream);
  if (fclose(stream) != 0 || k) failed(arguments[3], "cannot be written, the disk may be full", 1);
#if defined(_WIN32)
  remove(arguments[3]); /* rename does not replace there */
#endif
  if (rename(aside, arguments[3]) != 0) failed(arguments[3], strerror(errno), 2);
  unfinished = NULL;
  if (job.edited) fprintf(stderr, "gm-post: %s: was edited after the export, and the program says so\n", job.file);
  for (k = 0; k < job.roll_count; ++k) {
    free(job.rolls[k].theta);
    free(job.rolls[k].axes);
    free(job.rolls[k].seconds);
    free(job.rolls[k].cutter);
    free(job.rolls[k].bends);
  }
  free(job.rolls);
  free(job.passes);
  free(job.lines);
  free(text);
  free(aside);
  return 0;
}
