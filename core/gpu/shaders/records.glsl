// The records of core/lights as they lie in memory. Members that are vectors there are three floats
// here: a vec3 would be aligned to 16 bytes.

struct Float3 {
    float x, y, z;
};

// The record of lights/ranges/sphere_tree.h.
struct SphereNode {
    float x[8], y[8], z[8];
    uint link[8];
    float bounds[8];
};
const uint kLeaf = 0x80000000u, kEmpty = 0xffffffffu;

// The record of lights/ranges/ranges.h.
struct Turn {
    uint rank, draw;
};
struct RangedLight {
    Float3 center;
    float radius;
    float intensity;
};

// The record of lights/light/light_record.h, two 16-bit numbers to a word.
struct LightRecord {
    Float3 center;
    float radius;
    float intensity;
    uint axis_xy;
    uint axis_z_half_sine_o;
    uint sin_theta_e_two_sided;
};

// The record of lights/groups/light_groups.h.
struct LightGroup {
    Float3 center;
    float radius;
    float spread;
    float intensity;
    Float3 axis;
    float apex;
    float cosine;
    Float3 mean_normal;
    float diffuse;
    uint child;
};
const uint kNoGroup = 0xffffffffu;

// The record of lights/bvh/light_bvh.h.
struct MeansNode {
    float center[3][8];
    float radius[8];
    float spread[8];
    float intensity[8];
    float axis[3][8];
    float apex[8];
    float cosine[8];
    float mean_normal[3][8];
    float diffuse[8];
    uint child[8];
};
const uint kLight = 0x80000000u;

// The record of lightcull/light_sampler.h.
struct ShadingPoint {
    Float3 position;
    Float3 normal;
    uint set;
    float diffuse;
    Float3 lobe_axis;
    float lobe_alpha;
    float lobe_peak;
};

// The record of gpu/shaders.h.
struct Selected {
    uint light;
    float prob;
    float weight_sum;
    uint key;
};

// The record of gpu/breadth_first.h.
struct BreadthFirst {
    uint node;
    uint place;
};

vec3 vec(Float3 v) {
    return vec3(v.x, v.y, v.z);
}
