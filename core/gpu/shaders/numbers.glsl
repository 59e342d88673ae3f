// Random numbers and arithmetic that give the bits of base/ and lights/ranges/ranges.h. Whatever is
// computed is `precise`, here and everywhere: never contracted, never put in another order.

uint scramble(uint x) {
    x = (x ^ (x >> 16)) * 0x85ebca6bu;
    x = (x ^ (x >> 13)) * 0xc2b2ae35u;
    return x ^ (x >> 16);
}

uint64_t mix64(uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ul;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebul;
    return x ^ (x >> 31);
}

uint64_t hash(uint64_t a, uint64_t b) {
    return mix64(mix64(a + 0x9e3779b97f4a7c15ul) + b);
}

double uniform_double(uint64_t bits) {
    precise double number =
        double(uint(bits >> 32)) * 4294967296.0lf + double(uint(bits) & 0xfffff800u);
    precise double scaled = number * (1.0lf / 18446744073709551616.0lf);
    return scaled;
}

// The number as a float. Both halves are exact as floats, so that their sum is rounded once.
float to_float(uint bits) {
    precise float number = float(bits >> 16) * 65536.0 + float(bits & 0xffffu);
    return number;
}

float dot3(vec3 a, vec3 b) {
    precise float sum = a.x * b.x + a.y * b.y + a.z * b.z;
    return sum;
}

// The number rounded to a float. Where the result becomes a double again, compilers may leave the
// rounding out (Mesa 25 does), but not with integers in between. The number that is added is 0, as
// no tree has so many nodes.
float rounded(double exact) {
    return uintBitsToFloat(floatBitsToUint(float(exact)) + (job.node_count >> 31));
}

// The quotient of floats, rounded as the standard for them has it; a device's own may be off by
// some bits.
float quotient(float a, float b) {
    precise double exact = double(a) / double(b);
    return rounded(exact);
}
float root(float a) {
    precise double exact = sqrt(double(a));
    return rounded(exact);
}
