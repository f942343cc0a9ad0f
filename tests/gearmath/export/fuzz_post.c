/*
 * fuzz SETTINGS COUNT SEED: mutations of a settings file through gm-post.
 *
 * Each must end with status 2 and one sentence and no program, or with status 0, a program, and at most one sentence.
 * Prints how many were refused and how many were written; stops at the first that is neither, and leaves it in
 * case.settings. gm-post runs in this process: where it would end it comes back here, and what it holds is released.
 */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MOST_HELD = 4096 };
static void *held[MOST_HELD];
static FILE *opened[8], *said;
static jmp_buf ended;

static void *held_realloc(void *array, size_t size)
{
  void *larger = realloc(array, size);
  int k;
  for (k = 0; k < MOST_HELD && held[k] != array; ++k) {}
  if (k == MOST_HELD) abort();
  held[k] = larger;
  return larger;
}

static void held_free(void *array)
{
  int k;
  for (k = 0; k < MOST_HELD; ++k)
    if (array && held[k] == array) held[k] = NULL;
  free(array);
}

static FILE *held_fopen(const char *name, const char *mode)
{
  FILE *stream = fopen(name, mode);
  int k;
  for (k = 0; opened[k]; ++k) {}
  opened[k] = stream;
  return stream;
}

static int held_fclose(FILE *stream)
{
  int k;
  for (k = 0; k < 8; ++k)
    if (opened[k] == stream) opened[k] = NULL;
  return fclose(stream);
}

static void __attribute__((noreturn)) come_back(int status) { longjmp(ended, status + 1); }

#define main gm_post_main
#define exit come_back
#define realloc held_realloc
#define free held_free
#define fopen held_fopen
#define fclose held_fclose
#undef stderr
#define stderr said
#include "gm_post.c"
#include "curve.c"
#include "path.c"
#include "settings.c"
#include "text.c"
#undef main
#undef exit
#undef realloc
#undef free
#undef fopen
#undef fclose

static uint64_t state;

static uint64_t draw(uint64_t below)
{
  state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (state >> 33) % below;
}

static const char *const tokens[] = {"nan", "inf", "-inf", "1e308", "-1e308", "1e-320", "0", "-0", "-1", "1e9",
    "999999999999", "18446744073709551616", "0x1p3", "1.5.5", "+", "e", "{X}", "{", "}", "{{", "{UP}", "{F}", "{NAME}",
    "pass", "roll", "node 1", "b {F}", "travel A -1 1", "motion 0 0 0 0 0 0 0", "modulo 0", "\r\n", "\n", " ", "#", "1e-9",
    "3.14159"};
enum { TOKENS = sizeof tokens / sizeof *tokens };

/* Takes some characters out of a text, and puts others in. */
static size_t splice(char *text, size_t length, size_t at, size_t out, const char *in, size_t count)
{
  if (at + out > length) out = length - at;
  memmove(text + at + count, text + at + out, length - at - out);
  memcpy(text + at, in, count);
  return length - out + count;
}

static size_t line_at(const char *text, size_t at)
{
  while (at > 0 && text[at - 1] != '\n') --at;
  return at;
}

static size_t mutated(char *text, size_t length)
{
  const size_t at = draw(length), begin = line_at(text, at);
  char copy[512], one;
  size_t end = begin, word = at, count;
  const char *token = tokens[draw(TOKENS)];
  while (end < length && text[end] != '\n') ++end;
  if (end < length) ++end;
  while (word > begin && text[word - 1] != ' ') --word;
  count = end - begin < sizeof copy ? end - begin : sizeof copy;
  memcpy(copy, text + begin, count);
  switch (draw(8)) {
  case 0: one = (char)draw(256); return splice(text, length, at, 1, &one, 1);
  case 1: return splice(text, length, at, 1 + draw(4), "", 0);
  case 2: return splice(text, length, at, 0, token, strlen(token));
  case 3: return splice(text, length, begin, count, "", 0);
  case 4: return splice(text, length, begin, 0, copy, count);
  case 5: return splice(text, length, word, strcspn(text + word, " \n"), token, strlen(token));
  case 6: one = (char)('0' + draw(10)); return splice(text, length, at, 1, &one, 1);
  default: return splice(text, length, line_at(text, draw(length)), 0, copy, count);
  }
}

/* The status of a run; what it says goes into said. */
static int status_of_run(void)
{
  char *arguments[] = {"gm-post", "case.settings", "-o", "FUZZED.MPF", NULL};
  int back = setjmp(ended), k;
  if (back == 0) back = gm_post_main(4, arguments) + 1;
  for (k = 0; k < MOST_HELD; ++k) {
    free(held[k]);
    held[k] = NULL;
  }
  for (k = 0; k < 8; ++k)
    if (opened[k]) {
      fclose(opened[k]);
      opened[k] = NULL;
    }
  unfinished = NULL;
  return back - 1;
}

int main(int argument_count, char **given)
{
  static char original[1 << 20], text[2 << 20];
  size_t length, now, said_length, j;
  long count, k, refused = 0, written = 0;
  FILE *stream;
  if (argument_count != 4 || !(stream = fopen(given[1], "rb"))) return 9;
  length = fread(original, 1, sizeof original - 1, stream);
  fclose(stream);
  count = atol(given[2]);
  state = (uint64_t)atol(given[3]);
  for (k = 0; k < count; ++k) {
    char *words = NULL;
    int status, sentences = 0, times, is_there;
    memcpy(text, original, length + 1);
    now = length;
    for (times = 1 + (int)draw(3); times > 0 && now > 0; --times) {
      now = mutated(text, now);
      text[now] = '\0';
    }
    stream = fopen("case.settings", "wb");
    fwrite(text, 1, now, stream);
    fclose(stream);
    remove("FUZZED.MPF");
    said = open_memstream(&words, &said_length);
    status = status_of_run();
    fclose(said);
    for (j = 0; j < said_length; ++j) sentences += words[j] == '\n';
    is_there = access("FUZZED.MPF", F_OK) == 0;
    if (status == 2 && sentences == 1 && !is_there && access("FUZZED.MPF.part", F_OK) != 0) ++refused;
    else if (status == 0 && sentences <= 1 && is_there) ++written;
    else {
      printf("case %ld: status %d, %d sentences: %s\n", k, status, sentences, words);
      return 1;
    }
    free(words);
  }
  printf("%ld refused, %ld written\n", refused, written);
  return 0;
}
