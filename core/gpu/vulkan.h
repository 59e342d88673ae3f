#pragma once

// The loader is looked for at run time: nothing links to it.
#include <vulkan/vulkan_raii.hpp>
