// How far a bake says it is, and the bar that shows it.

#include "bar.h"
#include "ls_bake.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// clang-format off: cmocka wants the headers above before it
#include <cmocka.h>
// clang-format on

// ---- The bake -----------------------------------------------------------------------------------

// What was told, by stage.
typedef struct Heard
{
    uint32_t count[LS_BAKE_STAGE_COUNT]; // different fractions
    int stage;
    double last, largest_step;
} Heard;

static void hear(void* user, const char* stage, double fraction)
{
    Heard* heard = user;
    int index = 0;
    while (index < LS_BAKE_STAGE_COUNT &&
           strcmp(stage, ls_bake_stage_text((LsBakeStage)index)) != 0)
    {
        index++;
    }
    assert_in_range(index, heard->stage, LS_BAKE_STAGE_COUNT - 1);
    assert_true(fraction >= heard->last && fraction <= 1.0);
    heard->count[index] += fraction > heard->last;
    heard->largest_step =
        fraction - heard->last > heard->largest_step ? fraction - heard->last : heard->largest_step;
    heard->stage = index;
    heard->last = fraction;
}

// One object or several, every stage moves the bar on, and none by much at once.
static void bakes_go_on(void** state)
{
    (void)state;
    char output[] = "/tmp/ls-test-progress-XXXXXX";
    const int file = mkstemp(output);
    assert_true(file >= 0);
    close(file);
    const LsBakeInput inputs[] = {{.path = LS_SOURCE_DIR "/scenes/bunny.ply"},
                                  {.path = LS_SOURCE_DIR "/scenes/cornell.gltf"},
                                  {.path = LS_SOURCE_DIR "/scenes/bunny.ply"}};
    for (uint32_t count = 1; count <= 3; count += 2)
    {
        Heard heard = {0};
        const LsBakeDesc desc = {.inputs = inputs,
                                 .input_count = count,
                                 .output = output,
                                 .grid = 16,
                                 .patches = 2,
                                 .force = true,
                                 .threads = 1,
                                 .progress = hear,
                                 .progress_user = &heard};
        LsError error = {0};
        assert_int_equal(ls_bake_run(&desc, NULL, &error), LS_OK);
        assert_true(heard.last == 1.0);
        assert_true(heard.count[LS_BAKE_STAGE_IMPORT] > 1);
        assert_true(heard.count[LS_BAKE_STAGE_MESH] > 3);
        assert_true(heard.count[LS_BAKE_STAGE_VOXELS] > 10);
        assert_true(heard.count[LS_BAKE_STAGE_LINESPACE] > 10);
        assert_true(heard.largest_step < 0.2);
    }
    unlink(output);
}

// ---- The bar ------------------------------------------------------------------------------------

static void times_left(void** state)
{
    (void)state;
    static const struct
    {
        double seconds;
        const char* text;
    } times[] = {{-1.0, ""},
                 {0.0, "0 s left"},
                 {0.6, "1 s left"},
                 {9.4, "9 s left"},
                 {9.6, "about 10 s left"},
                 {12.0, "about 10 s left"},
                 {13.0, "about 15 s left"},
                 {89.0, "about 90 s left"},
                 {90.0, "about 2 min left"},
                 {149.0, "about 2 min left"},
                 {151.0, "about 3 min left"},
                 {5399.0, "about 90 min left"},
                 {5400.0, "about 2 h left"},
                 {1e300, "about 278 h left"}};
    for (size_t i = 0; i < sizeof times / sizeof *times; i++)
    {
        char text[32];
        ls_bar_time_left(times[i].seconds, text);
        assert_string_equal(text, times[i].text);
    }
}

static void bars(void** state)
{
    (void)state;
    static const struct
    {
        double time;
        const char* stage;
        double fraction;
        const char* text;
    } notes[] = {
        {100.0, "import", 0.0, "import     [                              ]   0 %  "},
        {109.0, "import", 0.02, "import     [                              ]   2 %  "},
        // The pace is that from here on: nine seconds of reading say nothing.
        {110.0, "voxels", 0.04, "voxels     [#                             ]   4 %  "},
        // A second and a tenth of it all, and not one of them alone.
        {110.5, "voxels", 0.20, "voxels     [######                        ]  20 %  "},
        {112.0, "voxels", 0.20,
         "voxels     [######                        ]  20 %  about 10 s left"},
        {118.0, "linespace", 0.36,
         "linespace  [##########                    ]  36 %  about 15 s left"},
        {134.0, "write", 0.99, "write      [############################# ]  99 %  0 s left"},
    };
    Bar bar = {0};
    for (size_t i = 0; i < sizeof notes / sizeof *notes; i++)
    {
        ls_bar_note(&bar, notes[i].time, notes[i].stage, notes[i].fraction);
        assert_string_equal(bar.text, notes[i].text);
    }
    // Slow from the start: no time is told before there is a tenth to tell it from.
    bar = (Bar){0};
    ls_bar_note(&bar, 0.0, "voxels", 0.05);
    ls_bar_note(&bar, 1000.0, "voxels", 0.14);
    assert_null(strstr(bar.text, "left"));
    ls_bar_note(&bar, 1000.0, "voxels", 0.16);
    assert_non_null(strstr(bar.text, "left"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bakes_go_on),
        cmocka_unit_test(times_left),
        cmocka_unit_test(bars),
    };
    return cmocka_run_group_tests_name("progress", tests, NULL, NULL);
}
