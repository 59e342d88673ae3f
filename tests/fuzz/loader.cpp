#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>

/// Takes any bytes as a scene file: loader.py loads them by the package, and says whether that went
/// as it must. Its lines of code are libFuzzer's counters.

namespace {

constexpr std::size_t kCounters = 1 << 14;
__attribute__((section("__libfuzzer_extra_counters"))) std::uint8_t counters[kCounters];

PyObject* count(PyObject*, PyObject* number) {
    ++counters[PyLong_AsUnsignedLongMask(number) % kCounters];
    Py_RETURN_NONE;
}

PyMethodDef methods[] = {{"count", count, METH_O, nullptr}, {nullptr, nullptr, 0, nullptr}};
PyModuleDef module{PyModuleDef_HEAD_INIT,
                   "fuzz_counters",
                   nullptr,
                   -1,
                   methods,
                   nullptr,
                   nullptr,
                   nullptr,
                   nullptr};

PyObject* make_module() {
    return PyModule_Create(&module);
}

[[noreturn]] void fail() {
    PyErr_Print();
    std::abort();
}

PyObject* find_load() {
    PyImport_AppendInittab("fuzz_counters", make_module);
    Py_InitializeEx(0);
    PyObject* const loader = PyImport_ImportModule("loader");
    if (loader == nullptr) fail();
    PyObject* const load = PyObject_GetAttrString(loader, "load");
    if (load == nullptr) fail();
    return load;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
    static PyObject* const load = find_load();
    PyObject* const result = PyObject_CallFunction(load, "y#", reinterpret_cast<const char*>(data),
                                                   static_cast<Py_ssize_t>(size));
    if (result == nullptr) fail();
    Py_DECREF(result);
    return 0;
}
