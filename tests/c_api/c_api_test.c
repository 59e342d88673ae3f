/* What a host in C sees: it lights a point, and makes each mistake once. That the numbers are those
   of C++ is tested in tests/unit/lights/c_api. */

#include <lightcull/lightcull.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures = 0;

static void check(int holds, const char* what, int line) {
    if (holds) return;
    ++failures;
    fprintf(stderr, "line %d: not so: %s (last error: %s)\n", line, what, lightcull_last_error());
}

#define CHECK(condition) check((condition), #condition, __LINE__)
/* That a call fails so, with that in its text. */
#define CHECK_FAILS(call, code, text) \
    check((call) == (code) && strstr(lightcull_last_error(), (text)) != NULL, #call, __LINE__)
#define CHECK_INVALID(call, text) CHECK_FAILS(call, LIGHTCULL_INVALID_ARGUMENT, text)

enum { kLights = 40 };

/* A ring of points, each brighter than the one before. */
static void make_lights(lightcull_light lights[kLights]) {
    int i;
    for (i = 0; i < kLights; ++i) {
        const float angle = 0.7f * (float)i;
        const float position[3] = {3.0f * cosf(angle), 1.0f + 0.1f * (float)(i % 7),
                                   2.0f * sinf(angle)};
        const lightcull_light dark = LIGHTCULL_LIGHT_INIT;
        lights[i] = dark;
        CHECK(lightcull_point_light(position, 1.0f + (float)i, &lights[i]) == LIGHTCULL_OK);
    }
}

static lightcull_shading_point floor_point(void) {
    lightcull_shading_point point = LIGHTCULL_SHADING_POINT_INIT;
    point.normal[1] = 1.0f;
    return point;
}

static float irradiance(const lightcull_light* light, const lightcull_shading_point* point) {
    float to_light[3], distance2 = 0.0f, cosine = 0.0f;
    int i;
    for (i = 0; i < 3; ++i) {
        to_light[i] = light->center[i] - point->position[i];
        distance2 += to_light[i] * to_light[i];
        cosine += to_light[i] * point->normal[i];
    }
    cosine /= sqrtf(distance2);
    return cosine > 0.0f ? light->intensity * cosine / distance2 : 0.0f;
}

static int are_equal(const lightcull_selection* a, const lightcull_selection* b) {
    return a->light == b->light && a->prob == b->prob && a->mis_prob == b->mis_prob &&
           a->receipt.weight_sum == b->receipt.weight_sum && a->receipt.key == b->receipt.key;
}

/* The samples of one pass converge to the light that arrives at a point. */
static void test_estimate(const char* description) {
    enum { kSamples = 16384 };
    static lightcull_shading_point points[kSamples];
    static lightcull_selection selections[kSamples];
    static float u[kSamples];
    lightcull_light lights[kLights];
    lightcull_sampler* sampler = NULL;
    lightcull_pass* pass = NULL;
    double sum = 0.0, expected = 0.0;
    uint32_t i;
    make_lights(lights);
    CHECK(lightcull_sampler_create(description, lights, kLights, NULL, &sampler) == LIGHTCULL_OK);
    CHECK(lightcull_pass_create(sampler, 5, &pass) == LIGHTCULL_OK);
    lightcull_sampler_destroy(sampler); /* which the pass outlives */
    for (i = 0; i < kSamples; ++i) {
        points[i] = floor_point();
        points[i].set = lightcull_set_of_sample(3, 4, i, 0, lightcull_set_count(pass));
        /* The golden ratio's multiples are spread evenly. */
        u[i] = (float)fmod(0.6180339887498949 * (double)i, 1.0);
        if (u[i] >= 1.0f) u[i] = 0.0f;
    }
    CHECK(lightcull_select_many(pass, points, u, kSamples, selections) == LIGHTCULL_OK);
    for (i = 0; i < kSamples; ++i) {
        lightcull_selection one;
        lightcull_select(pass, &points[i], u[i], &one);
        CHECK(are_equal(&one, &selections[i]));
        if (one.prob == 0.0f) continue;
        CHECK(one.light < kLights);
        CHECK(lightcull_prob(pass, &points[i], &one.receipt, one.light) == one.mis_prob);
        sum += (double)(irradiance(&lights[one.light], &points[i]) / one.prob);
    }
    for (i = 0; i < kLights; ++i) expected += (double)irradiance(&lights[i], &points[0]);
    /* Far more than the noise of any of them. */
    CHECK(fabs(sum / kSamples - expected) < 0.05 * expected);
    lightcull_pass_destroy(pass);
}

static void test_probabilities_are_those_of_the_sampler(void) {
    lightcull_light lights[kLights];
    lightcull_sampler* sampler = NULL;
    const lightcull_pass* pass;
    lightcull_shading_point point = floor_point();
    lightcull_selection selection;
    make_lights(lights);
    lights[0].intensity = 0.0f;
    CHECK(lightcull_sampler_create("uniform", lights, kLights, NULL, &sampler) == LIGHTCULL_OK);
    pass = lightcull_sampler_current_pass(sampler);
    CHECK(lightcull_set_count(pass) == 1);
    CHECK(lightcull_needs_receipt(pass) == 0);
    CHECK(lightcull_sampler_begin_pass(sampler, 1) == LIGHTCULL_OK);
    lightcull_select(pass, &point, 0.5f, &selection);
    CHECK(selection.prob == 1.0f / (kLights - 1));
    CHECK(lightcull_prob(pass, &point, NULL, 7) == 1.0f / (kLights - 1));
    CHECK(lightcull_prob(pass, &point, NULL, 0) == 0.0f);
    lightcull_sampler_destroy(sampler);

    CHECK(lightcull_sampler_create("culled", NULL, 0, NULL, &sampler) == LIGHTCULL_OK);
    pass = lightcull_sampler_current_pass(sampler);
    CHECK(lightcull_needs_receipt(pass) == 1);
    CHECK(lightcull_sampler_begin_pass(sampler, 1) == LIGHTCULL_OK);
    lightcull_select(pass, &point, 0.5f, &selection);
    CHECK(selection.prob == 0.0f);
    lightcull_sampler_destroy(sampler);
}

static void test_context(void) {
    lightcull_light lights[kLights];
    lightcull_context context = LIGHTCULL_CONTEXT_INIT;
    lightcull_shading_point points[2];
    lightcull_sampler* sampler = NULL;
    make_lights(lights);
    points[0] = points[1] = floor_point();
    context.points_per_pass = 640 * 480;
    context.calibration_points = points;
    context.calibration_point_count = 2;
    CHECK(lightcull_sampler_create("culled", lights, kLights, &context, &sampler) == LIGHTCULL_OK);
    /* A host that begins many passes needs fewer sets than the 4096 of others. */
    CHECK(lightcull_set_count(lightcull_sampler_current_pass(sampler)) < 4096);
    lightcull_sampler_destroy(sampler);
    CHECK(lightcull_sampler_create("culled", lights, kLights, NULL, &sampler) == LIGHTCULL_OK);
    CHECK(lightcull_set_count(lightcull_sampler_current_pass(sampler)) == 4096);
    lightcull_sampler_destroy(sampler);

    points[1].position[0] = (float)NAN;
    CHECK_INVALID(lightcull_sampler_create("culled", lights, kLights, &context, &sampler),
                  "calibration point 1 is not finite");
    context.calibration_points = NULL;
    CHECK_INVALID(lightcull_sampler_create("culled", lights, kLights, &context, &sampler),
                  "context: calibration_points is null");
    context.size = 4;
    CHECK_INVALID(lightcull_sampler_create("culled", lights, kLights, &context, &sampler),
                  "context: size is 4");
}

static void test_errors_of_samplers(void) {
    lightcull_light lights[kLights];
    lightcull_sampler* sampler = NULL;
    lightcull_pass* pass = NULL;
    make_lights(lights);
    CHECK_INVALID(lightcull_sampler_create("cull", lights, kLights, NULL, &sampler),
                  "sampler 'cull': unknown; there are uniform");
    CHECK(sampler == NULL);
    CHECK_INVALID(lightcull_sampler_create("culled:sets=3", lights, kLights, NULL, &sampler),
                  "sets is 3");
    CHECK_INVALID(lightcull_sampler_create(NULL, lights, kLights, NULL, &sampler),
                  "description is null");
    CHECK_INVALID(lightcull_sampler_create("culled", NULL, kLights, NULL, &sampler),
                  "lights is null");
    CHECK_INVALID(lightcull_sampler_create("culled", lights, kLights, NULL, NULL),
                  "sampler is null");
    CHECK_INVALID(lightcull_sampler_create("paper:list=0", lights, kLights, NULL, &sampler),
                  "paper:test=light");
    CHECK_INVALID(
        lightcull_checked_sampler_create("cull", lights, kLights, NULL, NULL, NULL, &sampler),
        "'cull'");
    CHECK_INVALID(lightcull_sampler_begin_pass(NULL, 1), "sampler is null");
    CHECK_INVALID(lightcull_pass_create(NULL, 1, &pass), "sampler is null");
    CHECK_INVALID(lightcull_pass_create(NULL, 1, NULL), "pass is null");
    CHECK(lightcull_sampler_current_pass(NULL) == NULL);
    lightcull_sampler_destroy(NULL);
    lightcull_pass_destroy(NULL);

    lights[3].radius = -1.0f;
    sampler = (lightcull_sampler*)lights;
    CHECK_INVALID(lightcull_sampler_create("culled", lights, kLights, NULL, &sampler),
                  "light 3: radius is -1");
    CHECK(sampler == NULL);
    lights[3].radius = 0.0f;
    lights[17].size = 0;
    CHECK_INVALID(lightcull_sampler_create("culled", lights, kLights, NULL, &sampler),
                  "light 17: size is 0");
    CHECK_INVALID(lightcull_use_instruction_set("MMX"), "'MMX'");
    CHECK_INVALID(lightcull_use_instruction_set(NULL), "name is null");
}

static void test_errors_of_lights(void) {
    const float a[3] = {0, 0, 0}, b[3] = {1, 0, 0}, c[3] = {0, 1, 0};
    lightcull_light light = LIGHTCULL_LIGHT_INIT;
    CHECK_INVALID(lightcull_triangle_light(a, NULL, c, 1, 0, &light), "b is null");
    CHECK_INVALID(lightcull_triangle_light(a, b, c, 1, 0, NULL), "light is null");
    light.size = sizeof light + 4;
    CHECK_INVALID(lightcull_triangle_light(a, b, c, 1, 0, &light), "light: size is ");
    CHECK(light.intensity == 0.0f);
    light.size = sizeof light;
    CHECK(lightcull_triangle_light(a, b, c, 1, 0, &light) == LIGHTCULL_OK);
    CHECK(light.intensity == 0.5f);
    CHECK(light.axis[2] == 1.0f);
    /* A text longer than its place is cut. */
    {
        char name[4000];
        lightcull_sampler* sampler;
        memset(name, 'x', sizeof name - 1);
        name[sizeof name - 1] = '\0';
        CHECK_INVALID(lightcull_sampler_create(name, &light, 1, NULL, &sampler), "sampler 'xxx");
        CHECK(strlen(lightcull_last_error()) == 1023);
    }
}

struct faults {
    int count;
    char text[200];
};

static void keep_fault(const char* fault, void* user_data) {
    struct faults* faults = (struct faults*)user_data;
    ++faults->count;
    strncpy(faults->text, fault, sizeof faults->text - 1);
}

static void test_checked_sampler(void) {
    struct faults faults = {0, ""};
    lightcull_light lights[kLights];
    lightcull_sampler* sampler = NULL;
    const lightcull_pass* pass;
    lightcull_shading_point point = floor_point();
    lightcull_selection selection;
    const float u = 0.5f;
    make_lights(lights);
    CHECK(lightcull_checked_sampler_create("culled:sets=16", lights, kLights, NULL, keep_fault,
                                           &faults, &sampler) == LIGHTCULL_OK);
    pass = lightcull_sampler_current_pass(sampler);
    lightcull_select(pass, &point, u, &selection);
    CHECK(strcmp(faults.text, "select(): begin_pass() must come first") == 0);
    CHECK(lightcull_sampler_begin_pass(sampler, 0) == LIGHTCULL_OK);
    CHECK(faults.count == 1);
    lightcull_select(pass, &point, u, &selection);
    CHECK(faults.count == 1 && selection.prob > 0.0f);
    CHECK(lightcull_prob(pass, &point, &selection.receipt, kLights - 1) > 0.0f);
    CHECK(faults.count == 1);
    CHECK(lightcull_prob(pass, &point, &selection.receipt, kLights) == 0.0f);
    CHECK(faults.count == 2 && strstr(faults.text, "no light of that index") != NULL);
    point.set = 16;
    CHECK(lightcull_select_many(pass, &point, &u, 1, &selection) == LIGHTCULL_OK);
    CHECK(selection.prob == 0.0f);
    CHECK(faults.count == 3 && strstr(faults.text, "point 0: set is not below") != NULL);
    lightcull_sampler_destroy(sampler);
}

static void test_library(void) {
    char name[32] = "";
    strncpy(name, lightcull_instruction_set(), sizeof name - 1);
    CHECK(lightcull_version()[0] >= '0' && strchr(lightcull_version(), '.') != NULL);
    CHECK(lightcull_use_instruction_set("scalar") == LIGHTCULL_OK);
    CHECK(strcmp(lightcull_instruction_set(), "scalar") == 0);
    CHECK(lightcull_use_instruction_set(name) == LIGHTCULL_OK);
    CHECK(strcmp(lightcull_instruction_set(), name) == 0);
}

/* Lights of even number are hidden. What is learned of that reaches the next pass, can be taken along
   to another sampler, and is lost where reports are dropped. */
static void test_learning(void) {
    enum { kRounds = 400 };
    lightcull_light lights[kLights];
    lightcull_sampler *sampler = NULL, *other = NULL, *culled = NULL;
    const lightcull_pass* pass = NULL;
    const lightcull_shading_point point = floor_point();
    uint8_t* learned = NULL;
    size_t size = 0;
    int i, round, hidden_at_first = 0, hidden_at_last = 0;
    make_lights(lights);
    CHECK(lightcull_sampler_create("learned", lights, kLights, NULL, &sampler) == LIGHTCULL_OK);
    CHECK(lightcull_sampler_create("learned", lights, kLights, NULL, &other) == LIGHTCULL_OK);
    CHECK(lightcull_sampler_create("culled", lights, kLights, NULL, &culled) == LIGHTCULL_OK);
    CHECK(!lightcull_wants_reports(lightcull_sampler_current_pass(culled)));
    pass = lightcull_sampler_current_pass(sampler);
    CHECK(lightcull_wants_reports(pass));
    for (round = 0; round < 4; ++round) {
        CHECK(lightcull_sampler_begin_pass(sampler, (uint64_t)round) == LIGHTCULL_OK);
        for (i = 0; i < kRounds; ++i) {
            lightcull_selection s;
            lightcull_outcome outcome = {{0, 0, 0}, {0, 1, 0}, {0, 0}, 0, 0};
            lightcull_select(pass, &point, ((float)i + 0.5f) / kRounds, &s);
            outcome.receipt = s.receipt;
            outcome.light = s.light;
            outcome.visibility = (float)(s.light % 2);
            if (round == 0) hidden_at_first += 1 - (int)(s.light % 2);
            if (round == 3) hidden_at_last += 1 - (int)(s.light % 2);
            lightcull_report(pass, &outcome, 1);
        }
    }
    CHECK(hidden_at_first > kRounds / 3);
    CHECK(hidden_at_last < hidden_at_first / 2);

    CHECK(lightcull_sampler_learned(sampler, NULL, &size) == LIGHTCULL_OK);
    CHECK(size > 0);
    learned = malloc(size);
    CHECK(lightcull_sampler_learned(sampler, learned, &size) == LIGHTCULL_OK);
    CHECK(lightcull_sampler_restore_learned(other, learned, size) == LIGHTCULL_OK);
    CHECK(lightcull_sampler_begin_pass(sampler, 9) == LIGHTCULL_OK);
    CHECK(lightcull_sampler_begin_pass(other, 9) == LIGHTCULL_OK);
    for (i = 0; i < 50; ++i) {
        lightcull_selection a, b;
        lightcull_select(pass, &point, ((float)i + 0.5f) / 50, &a);
        lightcull_select(lightcull_sampler_current_pass(other), &point, ((float)i + 0.5f) / 50, &b);
        CHECK(are_equal(&a, &b));
    }
    CHECK_INVALID(lightcull_sampler_restore_learned(other, learned, size / 2), "makes no sense");
    CHECK_INVALID(lightcull_sampler_restore_learned(culled, learned, size), "does not learn");
    CHECK_INVALID(lightcull_sampler_learned(sampler, learned, NULL), "size");
    size = 1;
    CHECK(lightcull_sampler_learned(culled, NULL, &size) == LIGHTCULL_OK && size == 0);
    lightcull_sampler_drop_reports(sampler);
    free(learned);
    lightcull_sampler_destroy(sampler);
    lightcull_sampler_destroy(other);
    lightcull_sampler_destroy(culled);
}

int main(void) {
    CHECK(strcmp(lightcull_last_error(), "") == 0);
    test_estimate("culled");
    test_estimate("light_bvh");
    test_estimate("uniform");
    test_estimate("paper:test=light:list=0:sets=4096");
    test_probabilities_are_those_of_the_sampler();
    test_context();
    test_errors_of_samplers();
    test_errors_of_lights();
    test_checked_sampler();
    test_learning();
    test_library();
    return failures == 0 ? 0 : 1;
}
