// test_check.c - every rule of SPEC.md has a file that breaks it and nothing else before it, and is
// named.

#include "check_cases.h"
#include "file_fixture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static LsResult check_all(const LsFixtureBytes* bytes, LsError* error)
{
    LsFile file;
    LsResult result = ls_file_open(&file, bytes->bytes, bytes->size, "broken", error);
    result = result == LS_OK ? ls_file_check(&file, "broken", error) : result;
    return result == LS_OK ? ls_file_check_hashes(&file, "broken", error) : result;
}

// Whether `bytes` are refused with `message` by `rule`; says so if not.
static bool is_refused(const LsFixtureBytes* bytes, LsMessage message, const char* rule,
                       const char* what)
{
    LsError error = {0};
    const LsResult got = check_all(bytes, &error);
    const char* named = strchr(error.text, 'R');
    const size_t length = strlen(rule);
    if (got != (LsResult)(message / 100) || error.result != got || error.message != message ||
        named == NULL || strncmp(named, rule, length) != 0 || strchr(":)", named[length]) == NULL ||
        strncmp(error.text, "broken: ", 8) != 0 || strchr(error.text, '\n') != NULL)
    {
        print_error("%s, %s: %u, \"%s\"\n", rule, what, error.message, error.text);
        return false;
    }
    return true;
}

static void apply_edit(const LsFixtureBytes* bytes, const Edit* edit)
{
    uint64_t offset = edit->offset;
    const LsEntry* entries = (const LsEntry*)(const void*)(bytes->bytes + LS_HEADER_BYTES);
    if (edit->place == PADDING)
    {
        offset = entries[edit->record].offset - 1;
    }
    else if (edit->place == ENTRY)
    {
        offset += LS_HEADER_BYTES + edit->record * LS_ENTRY_BYTES;
    }
    else if (edit->place < LS_CHUNK_COUNT)
    {
        assert_true(edit->record < entries[edit->place].element_count);
        offset += entries[edit->place].offset + edit->record * entries[edit->place].stride;
    }
    memcpy(bytes->bytes + offset, &edit->value, edit->size);
}

static void test_fixture_is_legal(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsFixtureBytes bytes = ls_fixture_bytes(&fixture.desc);
    LsError error = {0};
    const LsResult result = check_all(&bytes, &error);
    assert_string_equal(error.text, "");
    assert_int_equal(result, LS_OK);
    ls_fixture_free(&bytes);
}

// How many of the edits to a legal file are not refused by their rule.
static uint32_t count_failures(const LsFileDesc* desc, const Case* first, size_t count,
                               const char* what)
{
    LsFixtureBytes legal = ls_fixture_bytes(desc);
    LsFixtureBytes broken = {aligned_alloc(4096, (legal.size + 4095) / 4096 * 4096), legal.size};
    uint32_t failures = 0;
    for (size_t i = 0; i < count; ++i)
    {
        memcpy(broken.bytes, legal.bytes, legal.size);
        for (int k = 0; k < 3 && first[i].edits[k].size > 0; ++k)
        {
            apply_edit(&broken, &first[i].edits[k]);
        }
        ls_fixture_rehash(&broken);
        char name[32];
        snprintf(name, sizeof(name), "%s %zu", what, i);
        failures += !is_refused(&broken, first[i].message, first[i].rule, name);
    }
    ls_fixture_free(&broken);
    ls_fixture_free(&legal);
    return failures;
}

static void test_edits_break_their_rule(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    const size_t count = sizeof(cases) / sizeof(cases[0]);
    assert_int_equal(count_failures(&fixture.desc, cases, count, "case"), 0);
}

static void test_edits_of_exact_masks(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsShaftLayout exact = ls_mask_layout(&fixture.desc, true);
    const size_t count = sizeof(exact_cases) / sizeof(exact_cases[0]);
    assert_int_equal(count_failures(&exact.desc, exact_cases, count, "exact case"), 0);
    ls_shaft_layout_destroy(&exact);
}

static void test_edits_of_scene_shafts(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsShaftLayout scene = ls_scene_shaft_layout(&fixture.desc, 1);
    const size_t count = sizeof(scene_cases) / sizeof(scene_cases[0]);
    assert_int_equal(count_failures(&scene.desc, scene_cases, count, "scene case"), 0);
    ls_shaft_layout_destroy(&scene);
}

// R2.13 and R3.8: the same edit, the hash left as it was.
static void test_hashes_are_compared(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsFixtureBytes bytes = ls_fixture_bytes(&fixture.desc);
    bytes.bytes[offsetof(LsHeader, source_hash)] ^= 1;
    assert_true(is_refused(&bytes, LS_MESSAGE_LSPACE_DAMAGED_HEAD, "R2.13", "source_hash"));
    bytes.bytes[offsetof(LsHeader, source_hash)] ^= 1;
    bytes.bytes[bytes.size - 4] ^= 1; // a legal bit of the last key
    assert_true(is_refused(&bytes, LS_MESSAGE_LSPACE_DAMAGED_CHUNK, "R3.8", "a key"));
    ls_fixture_free(&bytes);
}

// ---- Files of other shapes ----------------------------------------------------------------------

static void expect_desc(const LsFileDesc* desc, const char* rule, const char* what)
{
    LsFixtureBytes bytes = ls_fixture_bytes(desc);
    assert_true(is_refused(&bytes, LS_MESSAGE_LSPACE_RULE, rule, what));
    ls_fixture_free(&bytes);
}

// Chunks of 0.2 that others need.
static void expect_missing(const LsFileDesc* whole)
{
    LsFileDesc desc = *whole;
    desc.SURFACES_count = 0;
    expect_desc(&desc, "R4.9", "no surfaces");
    desc = *whole;
    desc.TEXTURES_count = 0;
    expect_desc(&desc, "R4.12", "no textures");
    desc = *whole;
    desc.IMAGES_count = 0;
    expect_desc(&desc, "R4.13", "no images");
    desc = *whole;
    desc.PIXELS_count = 0;
    expect_desc(&desc, "R4.14", "no pixels");
    desc.SURFACES_count = desc.TEXTURES_count = desc.IMAGES_count = 0;
    desc.PIXELS_count = 1;
    const LsMaterial plain[2] = {desc.materials[0], desc.materials[0]};
    desc.materials = plain;
    desc.LIGHTS_count = 0;
    expect_desc(&desc, "R4.14", "pixels of no image");
    desc = *whole;
    desc.ATTRIBUTES_count = 0;
    expect_desc(&desc, "R4.15", "no attributes");
    desc.ATTRIBUTES_count = 2;
    expect_desc(&desc, "R4.15", "attributes of two objects of three");
    desc = *whole;
    desc.NORMALS_count = 0;
    expect_desc(&desc, "R4.15", "no normals");
    desc = *whole;
    desc.TEXCOORDS_count = 0;
    expect_desc(&desc, "R4.15", "no texture coordinates");
    desc = *whole;
    desc.COLORS_count = 0;
    expect_desc(&desc, "R4.15", "no colours");
    desc = *whole;
    desc.ANIMATIONS_count = 0;
    expect_desc(&desc, "R4.19", "no animations");
    desc.ANIMATIONS_count = 1;
    expect_desc(&desc, "R4.19", "channels of no animation");
    desc = *whole;
    desc.CHANNELS_count = 0;
    expect_desc(&desc, "R4.19", "no channels");
    desc = *whole;
    desc.KEYS_count = 0;
    expect_desc(&desc, "R4.20", "no keys");
    desc = *whole;
    desc.ANIMATIONS_count = desc.CHANNELS_count = 0;
    expect_desc(&desc, "R4.20", "keys of no channel");
}

static void test_missing_chunks(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsFileDesc desc = fixture.desc;
    desc.OBJECTS_count = 0;
    expect_desc(&desc, "R4.1", "no objects");
    desc = fixture.desc;
    desc.INSTANCES_count = 0;
    expect_desc(&desc, "R4.1", "no instances");
    desc = fixture.desc;
    desc.MATERIALS_count = 0;
    expect_desc(&desc, "R4.1", "no materials");
    desc = fixture.desc;
    desc.TRIANGLES_count = 0;
    expect_desc(&desc, "R4.1", "no triangles");
    desc = fixture.desc;
    desc.TOP_NODES_count = 0;
    expect_desc(&desc, "R4.6", "no top level");
    desc = fixture.desc;
    desc.NODES_count = 0;
    expect_desc(&desc, "R4.5", "no nodes");
    expect_missing(&fixture.desc);
    desc = fixture.desc;
    desc.VOXELS_count -= 1;
    expect_desc(&desc, "R4.2", "a voxel fewer");
    fixture.objects[1].triangle_count = 0;
    fixture.objects[2].first_triangle = 2;
    desc = fixture.desc;
    desc.TRIANGLES_count = 3;
    expect_desc(&desc, "R4.3", "an object without triangles");
}

static void expect_legal(const LsFileDesc* desc)
{
    LsFixtureBytes bytes = ls_fixture_bytes(desc);
    LsError error = {0};
    const LsResult result = check_all(&bytes, &error);
    assert_string_equal(error.text, "");
    assert_int_equal(result, LS_OK);
    ls_fixture_free(&bytes);
}

// Sides out of range whose pixels are all there.
static void test_image_sides(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    static const uint32_t pixels[2 + LS_MAX_IMAGE_SIDE + 1];
    fixture.desc.pixels = pixels;
    LsImage* image = &fixture.images[1];
    for (uint32_t over = 0; over < 2; ++over)
    {
        const uint32_t side = LS_MAX_IMAGE_SIDE + over;
        fixture.desc.PIXELS_count = 2 + side;
        image->width = side;
        image->height = 1;
        over == 0 ? expect_legal(&fixture.desc) : expect_desc(&fixture.desc, "R4.14", "wide");
        image->width = 1;
        image->height = side;
        over == 0 ? expect_legal(&fixture.desc) : expect_desc(&fixture.desc, "R4.14", "high");
    }
    fixture.desc.PIXELS_count = 2;
    image->height = 0;
    expect_desc(&fixture.desc, "R4.14", "of no height");
    image->height = 1;
    image->width = 0;
    expect_desc(&fixture.desc, "R4.14", "of no width");
}

// Records that hold nothing, one for each object, fewer, and more.
static void test_attributes_of_each_object(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    const LsAttributes none = {LS_NONE, {LS_NONE, LS_NONE}, LS_NONE};
    const LsAttributes attributes[4] = {none, none, none, none};
    LsFileDesc* desc = &fixture.desc;
    desc->attributes = attributes;
    desc->NORMALS_count = desc->TEXCOORDS_count = desc->COLORS_count = 0;
    desc->ATTRIBUTES_count = 3;
    expect_legal(desc);
    desc->ATTRIBUTES_count = 2;
    expect_desc(desc, "R4.15", "two for three objects");
    desc->ATTRIBUTES_count = 4;
    expect_desc(desc, "R4.15", "four for three objects");
}

// Two nodes in one animation, then channels without keys and with keys that are not quite shared.
static void test_layouts_of_channels(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    for (uint32_t i = 0; i < 3; ++i)
    {
        fixture.channels[i].node = 0;
        fixture.channels[3 + i].node = 2;
    }
    fixture.animations[0].channel_count = 6;
    fixture.animations[0].duration = 4;
    LsFileDesc* desc = &fixture.desc;
    desc->ANIMATIONS_count = 1;
    expect_legal(desc);
    for (uint32_t i = 0; i < 3; ++i)
    {
        fixture.channels[i].node = 2;
    }
    expect_desc(desc, "R4.20", "a node twice");

    ls_fixture_fill(&fixture);
    LsChannel* last = &fixture.channels[5];
    last->key_count = 0;
    last->first_time = last->first_value = 53;
    desc->KEYS_count = 53;
    expect_desc(desc, "R4.20", "no keys");
    ls_fixture_fill(&fixture);
    float keys[59];
    memcpy(keys, fixture.keys, sizeof(fixture.keys));
    memcpy(keys + 56, fixture.keys + 53, 3 * sizeof(float));
    desc->keys = keys;
    desc->KEYS_count = 59;
    last->key_count = 2;
    expect_desc(desc, "R4.20", "one time shared for two keys");
}

static void test_top_level_without_need(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    fixture.desc.INSTANCES_count = 1; // the identity
    fixture.desc.LIGHTS_count = 0;
    expect_desc(&fixture.desc, "R4.6", "one instance with the identity");
    fixture.instances[0].flags = 0;
    expect_desc(&fixture.desc, "R4.6", "four leaves for one instance");
    fixture.top_nodes[0].escape = 1;
    fixture.top_nodes[0].leaf = 1;
    fixture.desc.TOP_NODES_count = 1;
    LsFixtureBytes bytes = ls_fixture_bytes(&fixture.desc);
    LsError error = {0};
    assert_int_equal(check_all(&bytes, &error), LS_OK);
    ls_fixture_free(&bytes);
}

static void test_subgrids_without_blocks(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    fixture.objects[1].subgrid_count = 6;
    fixture.objects[2].first_subgrid = 6;
    const uint32_t subgrids[6] = {0};
    fixture.desc.subgrids = subgrids;
    fixture.desc.SUBGRIDS_count = 6;
    expect_desc(&fixture.desc, "R5.6", "more sub-grids than cell blocks");
}

static void test_node_levels(void** state)
{
    (void)state;
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsSceneNode nodes[LS_MAX_NODE_DEPTH + 1];
    for (uint32_t i = 0; i <= LS_MAX_NODE_DEPTH; ++i)
    {
        nodes[i] = fixture.nodes[0];
        nodes[i].parent = i == 0 ? LS_NONE : i - 1;
    }
    fixture.desc.nodes = nodes;
    fixture.desc.NODES_count = LS_MAX_NODE_DEPTH;
    LsFixtureBytes bytes = ls_fixture_bytes(&fixture.desc);
    LsError error = {0};
    assert_int_equal(check_all(&bytes, &error), LS_OK);
    ls_fixture_free(&bytes);
    fixture.desc.NODES_count = LS_MAX_NODE_DEPTH + 1;
    expect_desc(&fixture.desc, "R4.8", "65 levels");
}

// More instances than the check looks at in one go; the twice named one is in the last part.
static void test_many_instances(void** state)
{
    (void)state;
    enum
    {
        COUNT = 300000
    };
    LsFixture fixture;
    ls_fixture_fill(&fixture);
    LsInstance* instances = malloc(COUNT * sizeof(LsInstance));
    LsBvhNode* nodes = malloc((COUNT + 1) * sizeof(LsBvhNode));
    assert_non_null(instances);
    assert_non_null(nodes);
    nodes[0] = fixture.top_nodes[0];
    nodes[0].escape = COUNT + 1;
    for (uint32_t i = 0; i < COUNT; ++i)
    {
        instances[i] = fixture.instances[i % 4];
        nodes[i + 1] = fixture.top_nodes[2];
        nodes[i + 1].escape = i + 2;
        nodes[i + 1].leaf = (COUNT - 1 - i) << 4 | 1;
    }
    fixture.desc.instances = instances;
    fixture.desc.INSTANCES_count = COUNT;
    fixture.desc.top_nodes = nodes;
    fixture.desc.TOP_NODES_count = COUNT + 1;
    LsFixtureBytes bytes = ls_fixture_bytes(&fixture.desc);
    LsError error = {0};
    assert_int_equal(check_all(&bytes, &error), LS_OK);
    ls_fixture_free(&bytes);
    nodes[2].leaf = nodes[1].leaf;
    expect_desc(&fixture.desc, "R4.6", "the last instance twice");
    free(nodes);
    free(instances);
}

// ---- Completeness -------------------------------------------------------------------------------

// Rules that whole tests above break, or edits of other files than the fixture's.
static const char* const other_rules[] = {"R2.13", "R3.8", "R4.1", "R6.7"};

static bool is_covered(const char* rule)
{
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); ++i)
    {
        if (strcmp(cases[i].rule, rule) == 0)
        {
            return true;
        }
    }
    for (size_t i = 0; i < sizeof(other_rules) / sizeof(other_rules[0]); ++i)
    {
        if (strcmp(other_rules[i], rule) == 0)
        {
            return true;
        }
    }
    return false;
}

static void test_every_rule_is_broken_once(void** state)
{
    (void)state;
    LsFixtureBytes spec = ls_fixture_read(LS_SOURCE_DIR "/format/SPEC.md");
    spec.bytes[spec.size] = '\0'; // ls_fixture_read leaves room for it
    uint32_t found = 0;
    for (const char* at = strchr((const char*)spec.bytes, 'R'); at != NULL;
         at = strchr(at + 1, 'R'))
    {
        unsigned chapter, number;
        if (sscanf(at, "R%u.%u", &chapter, &number) == 2)
        {
            char rule[32];
            snprintf(rule, sizeof(rule), "R%u.%u", chapter, number);
            ++found;
            if (!is_covered(rule))
            {
                fail_msg("no test breaks %s", rule);
            }
        }
    }
    assert_in_range(found, 58, 1000);
    ls_fixture_free(&spec);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fixture_is_legal),
        cmocka_unit_test(test_edits_break_their_rule),
        cmocka_unit_test(test_edits_of_exact_masks),
        cmocka_unit_test(test_edits_of_scene_shafts),
        cmocka_unit_test(test_hashes_are_compared),
        cmocka_unit_test(test_missing_chunks),
        cmocka_unit_test(test_image_sides),
        cmocka_unit_test(test_attributes_of_each_object),
        cmocka_unit_test(test_layouts_of_channels),
        cmocka_unit_test(test_top_level_without_need),
        cmocka_unit_test(test_subgrids_without_blocks),
        cmocka_unit_test(test_node_levels),
        cmocka_unit_test(test_many_instances),
        cmocka_unit_test(test_every_rule_is_broken_once),
    };
    return cmocka_run_group_tests_name("check", tests, NULL, NULL);
}
