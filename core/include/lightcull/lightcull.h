#pragma once

/// The samplers of lightcull for hosts in C99, and in languages that call C: light_sampler.h,
/// samplers.h, light.h, sets.h and checked_sampler.h in short. What is said there of methods and
/// numbers holds here; the answers are the same, to the bit. A C host links with lightcull::lights,
/// which, where it is a static library, needs the C++ runtime: CMake links it in projects of the
/// languages C and CXX.
///
///     lightcull_sampler* sampler;
///     if (lightcull_sampler_create("culled", lights, count, NULL, &sampler) != LIGHTCULL_OK) {
///         fprintf(stderr, "%s\n", lightcull_last_error());
///         return 1;
///     }
///     lightcull_pass* pass;
///     ... lightcull_pass_create(sampler, 0, &pass) ...
///     lightcull_shading_point point = LIGHTCULL_SHADING_POINT_INIT;
///     ... position, normal, and set by lightcull_set_of_sample() ...
///     lightcull_selection s;
///     lightcull_select(pass, &point, u, &s);
///     if (s.prob > 0) ... the light s.light, its contribution divided by s.prob ...
///
/// Set-up calls return a lightcull_error. They check what they are given, null pointers too, and
/// have no effect where they fail, but for setting a handle that they were to make to NULL. Hot
/// calls check nothing, neither handles nor points: lightcull_checked_sampler_create() is for that.
///
/// Threads: any calls may run at the same time on any threads, but lightcull_sampler_begin_pass(),
/// lightcull_sampler_destroy() and lightcull_pass_destroy(), each while no other call uses the
/// handle, and lightcull_use_instruction_set(). Calls that take long work on the threads of TBB,
/// the caller's among them; the caller waits for them to finish.
///
/// Structs are of two kinds. What is set up once starts with its size, which the host sets to
/// sizeof of the struct: later versions add fields at the end and still take the sizes of today.
/// What hot calls take and give (point, receipt, selection) has a layout that never changes, and no
/// size: arrays of millions are read where they lie, no field of them says what all have in common,
/// and no call has to look at it. Should one of them have to grow, it will be another struct, with
/// functions of its own. No function returns a struct, so that no host has to agree on how that is
/// done.

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__) && !defined(LIGHTCULL_STATIC)
#define LIGHTCULL_C_API __attribute__((visibility("default")))
#else
#define LIGHTCULL_C_API
#endif

/// The library sees these structs as types of its own, of the same layout.
#if defined(__GNUC__)
#define LIGHTCULL_C_STRUCT __attribute__((may_alias))
#else
#define LIGHTCULL_C_STRUCT
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- errors ---------------------------------------------------------------------------------- */

/// The result of a call.
typedef enum lightcull_error {
    LIGHTCULL_OK = 0,
    LIGHTCULL_INVALID_ARGUMENT = 1,  ///< the text names what is wrong, as in "light 3: radius is
                                     ///< -1, ..."
    LIGHTCULL_OUT_OF_MEMORY = 2,
    LIGHTCULL_FAILED = 3  ///< anything else, such as threads that the system does not give
} lightcull_error;

/// One line about the last call on this thread that returned anything but LIGHTCULL_OK; "" before
/// there was one. The text has at most 1023 bytes; what is longer is cut. It is valid until the
/// next such call on this thread, or the end of the thread. Other threads have texts of their own.
LIGHTCULL_C_API const char* lightcull_last_error(void);

/* ---- lights ---------------------------------------------------------------------------------- */

/// What a sampler knows of one light: bounds, the directions it emits into, and how strongly. Light
/// (light.h) explains the cone, with a table of kinds of light.
typedef struct lightcull_light {
    uint32_t size;        ///< sizeof(lightcull_light)
    float center[3];      ///< centre of the bounding sphere, metres
    float radius;         ///< radius of the bounding sphere, metres, >= 0
    float axis[3];        ///< axis of the cone of normals, unit length
    float cos_theta_o;    ///< cosine of the half-angle of the cone of normals, [-1, 1]; 1: flat
    float cos_theta_e;    ///< cosine of the largest angle to a normal, [0, 1]
    float intensity;      ///< peak radiant intensity, W/sr, luminance-weighted, >= 0; of a
                          ///< directional light irradiance, W/m^2
    int32_t two_sided;    ///< other than 0: the light emits about -axis as it does about axis
    float lobe_alpha;     ///< alpha of a glossy point, [1e-3, 1]; 0 for all others
    int32_t directional;  ///< other than 0: the light is infinitely far and shines along axis;
                          ///< structs of a size without this field are taken, too
} lightcull_light;

/// A light at the origin that does not emit. Use in C++ and C: lightcull_light light
/// = LIGHTCULL_LIGHT_INIT;
#define LIGHTCULL_LIGHT_INIT \
    { sizeof(lightcull_light), {0, 0, 0}, 0, {0, 0, 1}, -1, 0, 0, 0, 0, 0 }

/* The calls below set all of *light but its size, which the host has set. They fail for a null
   pointer and for a size that is wrong; numbers out of range are found when a sampler is made. */

/// A triangle that emits `radiance` (mean over its area, luminance, W/(m^2 sr)) on the side from
/// which a, b, c (metres) run anticlockwise, or on both where two_sided is not 0. A triangle
/// without area gives a light of intensity 0.
LIGHTCULL_C_API lightcull_error lightcull_triangle_light(const float a[3], const float b[3],
                                                         const float c[3], float radiance,
                                                         int two_sided, lightcull_light* light);

/// A sphere that emits `radiance` (luminance, W/(m^2 sr)) from all of its outside. center, radius:
/// metres.
LIGHTCULL_C_API lightcull_error lightcull_sphere_light(const float center[3], float radius,
                                                       float radiance, lightcull_light* light);

/// A disc that emits `radiance` (luminance, W/(m^2 sr)) on the side of `normal` (any length but 0),
/// or on both where two_sided is not 0. center, radius: metres.
LIGHTCULL_C_API lightcull_error lightcull_disc_light(const float center[3], const float normal[3],
                                                     float radius, float radiance, int two_sided,
                                                     lightcull_light* light);

/// A tube from a to b that emits `radiance` (luminance, W/(m^2 sr)) from its side, but not from its
/// ends. a, b, radius: metres.
LIGHTCULL_C_API lightcull_error lightcull_cylinder_light(const float a[3], const float b[3],
                                                         float radius, float radiance,
                                                         lightcull_light* light);

/// A point (metres) that emits `intensity` (luminance, W/sr) in all directions.
LIGHTCULL_C_API lightcull_error lightcull_point_light(const float position[3], float intensity,
                                                      lightcull_light* light);

/// A point (metres) that emits `intensity` (luminance, W/sr) up to `inner` from `direction` (any
/// length but 0) and less and less to nothing at `outer`; radians, 0 <= inner <= outer <= pi.
LIGHTCULL_C_API lightcull_error lightcull_spot_light(const float position[3],
                                                     const float direction[3], float intensity,
                                                     float inner, float outer,
                                                     lightcull_light* light);

/// A point (metres) that emits with the cosine to `normal` (unit length), `intensity` (luminance,
/// W/sr) along it and nothing behind it: a diffuse virtual light.
LIGHTCULL_C_API lightcull_error lightcull_diffuse_point_light(const float position[3],
                                                              const float normal[3],
                                                              float intensity,
                                                              lightcull_light* light);

/// A point (metres) that emits `intensity` (luminance, W/sr) into `direction` (unit length) and
/// less about it, as GGX's D of `alpha` ([1e-3, 1]) falls: a glossy virtual light ([TH17]).
LIGHTCULL_C_API lightcull_error lightcull_glossy_point_light(const float position[3],
                                                             const float direction[3],
                                                             float intensity, float alpha,
                                                             lightcull_light* light);

/// A sun: parallel light from infinity that goes into `direction` (any length but 0) and gives
/// `irradiance` (luminance, W/m^2) to a surface that faces it. *light must have the field
/// `directional`.
LIGHTCULL_C_API lightcull_error lightcull_directional_light(const float direction[3],
                                                            float irradiance,
                                                            lightcull_light* light);

/// A light of which only a box (metres), a cone of directions and the radiant power (luminance, W)
/// are known. The cone is that of lightcull_light.
LIGHTCULL_C_API lightcull_error lightcull_bounded_light(const float box_min[3],
                                                        const float box_max[3], const float axis[3],
                                                        float cos_theta_o, float cos_theta_e,
                                                        int two_sided, float power,
                                                        lightcull_light* light);

/* ---- what hot calls take and give; these layouts never change ---------------------------------
 */

/// The glossy part of what a surface does with light: GlossyLobe (light_sampler.h) says how it
/// follows from a BSDF.
typedef struct LIGHTCULL_C_STRUCT lightcull_lobe {
    float axis[3];  ///< mirror direction of the view, unit length
    float alpha;    ///< (0, 1]
    float peak;     ///< value at the axis, in units of `diffuse` of the point, >= 0; 0: there is no
                    ///< glossy part
} lightcull_lobe;

/// A point to be lit. Where diffuse and lobe.peak are both 0, no light is ever selected.
typedef struct LIGHTCULL_C_STRUCT lightcull_shading_point {
    float position[3];    ///< metres
    float normal[3];      ///< normal of unit length, on the side that receives light; 0 in a volume
                          ///< or where light from both sides counts
    uint32_t set;         ///< set of random ranges to use, < lightcull_set_count()
    float diffuse;        ///< diffuse albedo / pi, in any unit, >= 0; 1 where there is no lobe
    lightcull_lobe lobe;  ///< glossy lobe of a surface that has one
} lightcull_shading_point;

/// A diffuse point at the origin, in a volume.
#define LIGHTCULL_SHADING_POINT_INIT  \
    {                                 \
        {0, 0, 0}, {0, 0, 0}, 0, 1, { \
            {0, 0, 1}, 1, 0           \
        }                             \
    }

/// What a path carries from selection to lightcull_prob(): an account of all that could have been
/// selected at a point. It does not depend on u, and it is valid where prob is 0. When a ray that
/// left the point hits a light, the receipt that lightcull_prob() needs is that of the point which
/// the ray left. Its numbers mean something to the sampler alone, in the pass of the selection.
typedef struct LIGHTCULL_C_STRUCT lightcull_receipt {
    float weight_sum;
    uint32_t key;
} lightcull_receipt;

/// The light chosen for a point.
typedef struct LIGHTCULL_C_STRUCT lightcull_selection {
    uint32_t light;  ///< index into the lights that the sampler was made over
    float prob;      ///< probability of the light, to divide its contribution by; in (0, 1], or 0
                     ///< where no light was chosen, which is no error: the contribution is 0
    float mis_prob;  ///< what lightcull_prob() says of the light, for MIS weights
    lightcull_receipt receipt;
} lightcull_selection;

/// What became of a light that was selected for a point: what a sampler may learn from.
typedef struct LIGHTCULL_C_STRUCT lightcull_outcome {
    float position[3];          ///< of the point, as in lightcull_shading_point
    float normal[3];            ///< of the point, as in lightcull_shading_point
    lightcull_receipt receipt;  ///< of the selection
    uint32_t light;             ///< of the selection
    float visibility;  ///< share of the light's rays that arrived, [0, 1]: 0 where a shadow
                       ///< ray was blocked, 1 or a transmittance where not
} lightcull_outcome;

/* ---- samplers -------------------------------------------------------------------------------- */

/// A sampler, to draw passes from. It is made by the two calls below, and freed by
/// lightcull_sampler_destroy().
typedef struct lightcull_sampler lightcull_sampler;

/// Random ranges that were drawn, to select from.
///
/// One pass is not enough. A selection is unbiased over passes, not within one: for the ranges of a
/// single pass and set, the mean over u alone is off. Sums converge over passes, or over the sets
/// of a pass that has many (see sets.h).
typedef struct lightcull_pass lightcull_pass;

/// The use that a sampler is put to.
typedef struct lightcull_context {
    uint32_t size;             ///< sizeof(lightcull_context)
    uint32_t points_per_pass;  ///< number of pixels, for a host that begins a pass for each sample
                               ///< of the image; 0: not known
    /// Some hundred points typical of the scene, on which ranges are calibrated; none: points drawn
    /// from the bounds of the lights. They are read while the sampler is made.
    const lightcull_shading_point* calibration_points;
    size_t calibration_point_count;
} lightcull_context;

#define LIGHTCULL_CONTEXT_INIT \
    { sizeof(lightcull_context), 0, NULL, 0 }

/// Makes *sampler over `count` lights, of which it copies what it needs.
///
/// description: a name, then options, as in "culled", "culled:sets=16" or "light_bvh"; samplers.h
/// has them all. `paper` with its test at the vertex, which is its default, is for C++ hosts (they
/// have to finish the test themselves) and refused here: "paper:test=light" is not. lights: may be
/// NULL where count is 0; then selections have prob 0. context: NULL is LIGHTCULL_CONTEXT_INIT.
///
/// It fails with a text that names the light and the field, or the option.
LIGHTCULL_C_API lightcull_error lightcull_sampler_create(const char* description,
                                                         const lightcull_light* lights,
                                                         size_t count,
                                                         const lightcull_context* context,
                                                         lightcull_sampler** sampler);

/// A function that is told what a host does wrong, in one line that is valid during the call, and
/// given the pointer that came with it. It may be called from any thread, and from several at once.
/// It must return by `return`: neither exceptions nor longjmp may leave it.
typedef void (*lightcull_fault_handler)(const char* fault, void* user_data);

/// Makes a sampler as lightcull_sampler_create() does, for finding a host's faults: the hot calls
/// on its passes check points, sets, u, lights and receipts, and selections before the first
/// lightcull_sampler_begin_pass(). Each call that finds a fault tells `on_fault`, selects nothing
/// (prob 0), and does not reach the sampler. Calls without a fault are answered as ever. on_fault:
/// NULL prints the fault to the standard error, and aborts the process. Handles and other pointers
/// are not checked.
LIGHTCULL_C_API lightcull_error lightcull_checked_sampler_create(
    const char* description, const lightcull_light* lights, size_t count,
    const lightcull_context* context, lightcull_fault_handler on_fault, void* user_data,
    lightcull_sampler** sampler);

/// Frees a sampler, but not the passes that lightcull_pass_create() made of it. NULL is left alone.
LIGHTCULL_C_API void lightcull_sampler_destroy(lightcull_sampler* sampler);

/// Draws the ranges of a pass, which is lightcull_sampler_current_pass() then; equal numbers give
/// equal ranges. The call takes some 10 ns per set and range, of which culled has one for each
/// group of lights. Where it fails, it has to be called again before anything is selected from that
/// pass.
LIGHTCULL_C_API lightcull_error lightcull_sampler_begin_pass(lightcull_sampler* sampler,
                                                             uint64_t number);

/// The pass that lightcull_sampler_begin_pass() changes, from which nothing may be selected before
/// that was called; always the same pointer. It belongs to the sampler, and is not to be destroyed.
/// The answer to NULL is NULL.
LIGHTCULL_C_API const lightcull_pass* lightcull_sampler_current_pass(
    const lightcull_sampler* sampler);

/// Makes *pass an object of its own that holds what lightcull_sampler_begin_pass() would draw: it
/// shares the tree with the sampler, never changes, and may outlive it. It takes the time of
/// lightcull_sampler_begin_pass() and some 5 bytes per set and group of lights. It is freed by
/// lightcull_pass_destroy().
LIGHTCULL_C_API lightcull_error lightcull_pass_create(const lightcull_sampler* sampler,
                                                      uint64_t number, lightcull_pass** pass);

/// Frees a pass that lightcull_pass_create() made. NULL is left alone.
LIGHTCULL_C_API void lightcull_pass_destroy(lightcull_pass* pass);

/// What lightcull_sampler_update() did.
typedef struct lightcull_update {
    uint32_t size;    ///< sizeof(lightcull_update)
    int32_t rebuilt;  ///< other than 0: the tree was built anew
    float growth;     ///< looseness of the tree before that, relative to when it was last built: 1
                      ///< is as tight
} lightcull_update;

#define LIGHTCULL_UPDATE_INIT \
    { sizeof(lightcull_update), 0, 1 }

/// Takes lights that have moved, changed or been switched: `count` has to be the number that the
/// sampler was made over. The tree is fitted to them where it can be, and built anew if it has
/// grown looser than max_growth; LightSampler::update() (light_sampler.h) says more. A pass has to
/// begin after it; those of lightcull_pass_create() stay what they are. update: NULL, or where to
/// write what was done. Only while nothing selects from the current pass. Fails, and changes
/// nothing, with a text that names the light and the field.
LIGHTCULL_C_API lightcull_error lightcull_sampler_update(lightcull_sampler* sampler,
                                                         const lightcull_light* lights,
                                                         size_t count, float max_growth,
                                                         lightcull_update* update);

/// Number of sets of random ranges, a power of 4. 1: it does not matter which a point uses.
LIGHTCULL_C_API uint32_t lightcull_set_count(const lightcull_pass* pass);

/// 0 if lightcull_prob() does not look at the receipt, which need not be kept then, else 1.
LIGHTCULL_C_API int lightcull_needs_receipt(const lightcull_pass* pass);

/// What has been learned and reported since the sampler was made; LightSampler::learned()
/// (light_sampler.h) says more. *size: the bytes there is room for at `bytes`, which may be NULL
/// where that is 0; then their number, which is 0 if the sampler does not learn. Nothing is written
/// to `bytes` where there is not room for all. Only while nothing reports.
LIGHTCULL_C_API lightcull_error lightcull_sampler_learned(const lightcull_sampler* sampler,
                                                          uint8_t* bytes, size_t* size);

/// Goes on as the sampler would of which lightcull_sampler_learned() gave the bytes. A pass has to
/// begin after it. Fails, and changes nothing, for bytes of another version or over other lights,
/// or that make no sense, and for any if the sampler does not learn.
LIGHTCULL_C_API lightcull_error lightcull_sampler_restore_learned(lightcull_sampler* sampler,
                                                                  const uint8_t* bytes,
                                                                  size_t size);

/// Forgets what has been reported since the last lightcull_sampler_begin_pass(), as a host does
/// that drops a pass under way.
LIGHTCULL_C_API void lightcull_sampler_drop_reports(lightcull_sampler* sampler);

/// 0 if lightcull_report() need not be called: the sampler does not learn, or not from this pass;
/// else 1.
LIGHTCULL_C_API int lightcull_wants_reports(const lightcull_pass* pass);

/* ---- hot calls ------------------------------------------------------------------------------- */

/// Chooses a light for a point by the random number u in [0, 1), which is used up: take fresh
/// numbers for all else. The call never fails.
LIGHTCULL_C_API void lightcull_select(const lightcull_pass* pass,
                                      const lightcull_shading_point* point, float u,
                                      lightcull_selection* selection);

/// Chooses a light for each of `count` points, at most 2^32 - 1: selections[i] is that of points[i]
/// and u[i], to the bit. A call is faster per point the more points there are, up to a whole image.
/// It works on all threads of TBB, and needs some 20 bytes of memory a point: it returns
/// LIGHTCULL_OUT_OF_MEMORY where it does not get them, before anything is written.
LIGHTCULL_C_API lightcull_error lightcull_select_many(const lightcull_pass* pass,
                                                      const lightcull_shading_point* points,
                                                      const float* u, size_t count,
                                                      lightcull_selection* selections);

/// The probability of `light`, an index into the lights, at a point whose receipt is at hand, for
/// MIS weights. The probability is that of the light as a whole: the density of a vertex on it, by
/// area or solid angle, is the caller's to multiply with. receipt: may be NULL where
/// lightcull_needs_receipt() is 0. The call never fails.
LIGHTCULL_C_API float lightcull_prob(const lightcull_pass* pass,
                                     const lightcull_shading_point* point,
                                     const lightcull_receipt* receipt, uint32_t light);

/// Reports what became of `count` selected lights, to a sampler that learns; others do not listen.
/// It may be called from any thread and in any order, with any part of the selections of the pass,
/// and does not change what the pass selects: what was learned is used from the next
/// lightcull_sampler_begin_pass() on. Outcomes that make no sense are left out. The call never
/// fails.
LIGHTCULL_C_API void lightcull_report(const lightcull_pass* pass, const lightcull_outcome* outcomes,
                                      size_t count);

/* ---- which set a point uses; sets.h says when to take which ------------------------------------
 */

/// The set for camera points of pixel (x, y) in a pass, in hosts that begin a pass for each sample.
/// pass: the number of the pass, or any other that differs from pass to pass. set_count: number of
/// sets of the pass, a power of 4.
LIGHTCULL_C_API uint32_t lightcull_set_of_pixel(uint32_t x, uint32_t y, uint64_t pass,
                                                uint32_t set_count);

/// Number of points that lie together and share a set at later bounces.
#define LIGHTCULL_POINTS_PER_PACKET 16

/// The set for the points of packet `packet` of later bounces, in hosts that begin a pass for each
/// sample.
LIGHTCULL_C_API uint32_t lightcull_set_of_packet(uint32_t packet, uint32_t set_count);

/// The set for a sample of pixel (x, y) at a vertex of its path, in hosts that select from one pass
/// for many samples; bounce 0 is what the camera sees.
LIGHTCULL_C_API uint32_t lightcull_set_of_sample(uint32_t x, uint32_t y, uint32_t sample,
                                                 uint32_t bounce, uint32_t set_count);

/* ---- the library ----------------------------------------------------------------------------- */

/// The version of the library that is linked, as in "0.2.0". The text is never freed.
LIGHTCULL_C_API const char* lightcull_version(void);

/// The instruction set that selection uses, as in "AVX2"; all give the same bits. The text is never
/// freed. The answer is NULL, with a text, where memory lacks.
LIGHTCULL_C_API const char* lightcull_instruction_set(void);

/// Makes all samplers of the process use another instruction set, for tests and benchmarks. It must
/// be called only while no selection runs. It fails for a set that this machine has not, with a
/// text that names those it has.
LIGHTCULL_C_API lightcull_error lightcull_use_instruction_set(const char* name);

#ifdef __cplusplus
}
#endif
