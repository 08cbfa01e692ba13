/* SPDX-License-Identifier: Apache-2.0
 * Checks of tests in C: each prints what failed and where; a test ends with the number of failures. */
#ifndef REFLECTREE_TESTS_C_CHECK_H
#define REFLECTREE_TESTS_C_CHECK_H

#include <math.h>
#include <stdio.h>
#include <string.h>

static int check_failures = 0;

#define CHECK(condition)                                                   \
  do {                                                                     \
    if (!(condition)) {                                                    \
      ++check_failures;                                                    \
      printf("%s:%d: %s does not hold\n", __FILE__, __LINE__, #condition); \
    }                                                                      \
  } while (0)

/* A call that must end with a status, and say why in a sentence with these words. */
#define CHECK_STATUS(call, wanted, words)                                                                    \
  do {                                                                                                       \
    const reflectree_status check_status = (call);                                                           \
    if (check_status != (wanted)) {                                                                          \
      ++check_failures;                                                                                      \
      printf("%s:%d: %s is '%s', not '%s': %s\n", __FILE__, __LINE__, #call,                                 \
             reflectree_status_name(check_status), reflectree_status_name(wanted), reflectree_last_error()); \
    } else if ((wanted) != REFLECTREE_OK && !strstr(reflectree_last_error(), (words))) {                     \
      ++check_failures;                                                                                      \
      printf("%s:%d: no '%s' in: %s\n", __FILE__, __LINE__, (words), reflectree_last_error());               \
    }                                                                                                        \
  } while (0)
#define CHECK_OK(call) CHECK_STATUS(call, REFLECTREE_OK, "")

static int check_result(const char* name) {
  printf("%s: %d checks failed\n", name, check_failures);
  return check_failures == 0 ? 0 : 1;
}

#endif
