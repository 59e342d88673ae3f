// The twin of lights/ranges/sphere_tree_walk.h: the nodes that are still to be read, in the order
// of TreeWalk.

// True if the node found first is read next. The nodes are then in breadth-first order, and a bit
// for each node holds them. Else they are a stack.
layout(constant_id = 0) const bool kFirstInFirstOut = true;
// The number of words: of bits, or as many nodes as may wait.
layout(constant_id = 1) const uint kRoom = 1;

uint waiting[kRoom];
uint at = 0;  // word that is read next, or height of the stack

void start_walk() {
    if (kFirstInFirstOut) {
        for (uint i = 0; i < kRoom; ++i) waiting[i] = 0;
        waiting[0] = 1;
    } else {
        waiting[at++] = 0;
    }
}

// Takes a node. False once none is left.
bool take(out uint node) {
    if (!kFirstInFirstOut) {
        if (at == 0) return false;
        node = waiting[--at];
        return true;
    }
    while (at < kRoom && waiting[at] == 0) ++at;
    if (at == kRoom) return false;
    const uint bit = uint(findLSB(waiting[at]));
    waiting[at] &= waiting[at] - 1;
    node = breadth_first[32 * at + bit].node;
    return true;
}

void add(uint node) {
    if (!kFirstInFirstOut) {
        waiting[at++] = node;
        return;
    }
    const uint place = breadth_first[node].place;
    waiting[place / 32] |= 1u << (place % 32);
}
