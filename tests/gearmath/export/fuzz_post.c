/*
 * fuzz SETTINGS COUNT SEED: mutations of a settings file through gm-post, each in a process of its own.
 *
 * Each must end with status 2 and one sentence and no program, or with status 0, a program, and at most one sentence.
 * Prints how many were refused and how many were written; stops at the first that is neither, and leaves it in case.settings.
 */
#define main gm_post_main
#include "gm_post.c"
#undef main

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

static uint64_t state;

static uint64_t draw(uint64_t below)
{
  state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (state >> 33) % below;
}

static const char *const tokens[] = {"nan", "inf", "-inf", "1e308", "-1e308", "1e-320", "0", "-0", "-1", "1e9", "999999999999",
    "18446744073709551616", "0x1p3", "1.5.5", "+", "e", "{X}", "{", "}", "{{", "{UP}", "{F}", "{NAME}", "pass", "roll", "node 1",
    "b {F}", "travel A -1 1", "motion 0 0 0 0 0 0 0", "modulo 0", "\r\n", "\n", " ", "#", "1e-9", "3.14159"};
enum { TOKENS = sizeof tokens / sizeof *tokens };

/* Splices into text: takes out some characters, puts others in. */
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

int main(int argument_count, char **given)
{
  char *original, *text, message[4096];
  size_t length;
  long count, k, refused_count = 0, written = 0;
  if (argument_count != 4) return 9;
  original = contents(given[1], &length);
  text = malloc(length + 65536);
  count = atol(given[2]);
  state = (uint64_t)atol(given[3]);
  for (k = 0; k < count; ++k) {
    size_t now = length, got = 0;
    ssize_t part;
    int pipe_ends[2], status, sentences = 0, times = 1 + (int)draw(3), there;
    FILE *stream;
    pid_t child;
    memcpy(text, original, length + 1);
    for (; times > 0 && now > 0; --times) now = mutated(text, now), text[now] = '\0';
    stream = fopen("case.settings", "wb");
    fwrite(text, 1, now, stream);
    fclose(stream);
    remove("FUZZED.MPF");
    if (pipe(pipe_ends) != 0) return 9;
    child = fork();
    if (child == 0) {
      char *arguments[] = {(char *)"gm-post", (char *)"case.settings", (char *)"-o", (char *)"FUZZED.MPF", NULL};
      dup2(pipe_ends[1], 2);
      close(pipe_ends[0]);
      exit(gm_post_main(4, arguments));
    }
    close(pipe_ends[1]);
    while (got < sizeof message && (part = read(pipe_ends[0], message + got, sizeof message - got)) > 0) got += (size_t)part;
    close(pipe_ends[0]);
    waitpid(child, &status, 0);
    for (size_t j = 0; j < got; ++j) sentences += message[j] == '\n';
    there = access("FUZZED.MPF", F_OK) == 0;
    if (WIFEXITED(status) && WEXITSTATUS(status) == 2 && sentences == 1 && !there && access("FUZZED.MPF.part", F_OK) != 0)
      ++refused_count;
    else if (WIFEXITED(status) && WEXITSTATUS(status) == 0 && sentences <= 1 && there)
      ++written;
    else {
      printf("case %ld: status %d, %d sentences: %.*s\n", k, status, sentences, (int)got, message);
      return 1;
    }
  }
  printf("%ld refused, %ld written\n", refused_count, written);
  free(original);
  free(text);
  return 0;
}
