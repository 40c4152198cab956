// test_catalogue.c - the catalogue of messages: legal numbers, none twice. That each has its entry in
// docs/errors.md and its test is asked by test_messages.sh.

// cmocka.h needs what stands before it.
// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#include "ls_base.h"
#include "ls_messages.h"

#include <stdlib.h>
#include <string.h>

typedef struct Message
{
    const char* name;
    uint32_t number;
} Message;

typedef struct List
{
    const char* name;
    const Message* messages; // up to the first without name
} List;

#define MESSAGE(name, number) {#name, number},
#define LIST_OF_ALL(X) \
    X(USAGE)           \
    X(FILES)           \
    X(PLY)             \
    X(OBJ)             \
    X(OFF)             \
    X(STL)             \
    X(GLTF)            \
    X(SCENE)           \
    X(INPUT)           \
    X(OUTPUT)          \
    X(LSPACE)          \
    X(DEVICE)          \
    X(MEMORY)
#define ARRAY(topic) \
    static const Message messages_##topic[] = {LS_MESSAGES_##topic(MESSAGE){NULL, 0}};
LIST_OF_ALL(ARRAY)
#define LIST(topic) {#topic, messages_##topic},
static const List lists[] = {LIST_OF_ALL(LIST)};
static const Message all[] = {LS_MESSAGE_LIST(MESSAGE){NULL, 0}};

static size_t count_messages(const Message* messages)
{
    size_t count = 0;
    while (messages[count].name != NULL)
    {
        ++count;
    }
    return count;
}

// number / 100 is a result, so that number, result and exit code agree.
static void test_numbers_are_results(void** state)
{
    (void)state;
    assert_int_not_equal(count_messages(all), 0);
    for (const Message* message = all; message->name != NULL; ++message)
    {
        const LsResult result = (LsResult)(message->number / 100);
        LsError error = {0};
        assert_int_equal(ls_error_set(&error, (int)message->number, "%s", message->name), result);
        assert_int_equal(error.result, result);
        assert_int_equal(error.message, message->number);
        assert_string_equal(error.text, message->name);
        if (message->number % 100 == 0 || result == LS_OK ||
            strcmp(ls_result_text(result), "unknown result") == 0 ||
            ls_result_exit_code(result) == LS_EXIT_OK)
        {
            fail_msg("%s: %u is of no result", message->name, message->number);
        }
    }
}

static void test_numbers_rise(void** state)
{
    (void)state;
    size_t count = 0;
    for (size_t i = 0; i < sizeof(lists) / sizeof(lists[0]); ++i)
    {
        uint32_t before = 0;
        for (const Message* message = lists[i].messages; message->name != NULL; ++message)
        {
            if (message->number <= before)
            {
                fail_msg("%s: %s, %u, stands behind %u", lists[i].name, message->name,
                         message->number, before);
            }
            before = message->number;
            ++count;
        }
    }
    assert_int_equal(count, count_messages(all)); // no list is forgotten here
}

static int compare_messages(const void* left, const void* right)
{
    const uint32_t a = ((const Message*)left)->number, b = ((const Message*)right)->number;
    return (a > b) - (a < b);
}

static void test_numbers_are_unique(void** state)
{
    (void)state;
    Message sorted[sizeof(all) / sizeof(all[0])];
    memcpy(sorted, all, sizeof(all));
    const size_t count = count_messages(all);
    qsort(sorted, count, sizeof(sorted[0]), compare_messages);
    for (size_t i = 1; i < count; ++i)
    {
        if (sorted[i].number == sorted[i - 1].number)
        {
            fail_msg("%s and %s are both %u", sorted[i - 1].name, sorted[i].name, sorted[i].number);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers_are_results),
        cmocka_unit_test(test_numbers_rise),
        cmocka_unit_test(test_numbers_are_unique),
    };
    return cmocka_run_group_tests_name("catalogue", tests, NULL, NULL);
}
