#include <doctest/doctest.h>
#include <fcntl.h>
#include <lightcull/error.h>
#include <lightcull/image/whole_file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

/// Files that are replaced whole, with a disk that fails and a process that dies at any step. The
/// linker sends the library's calls of the system here first.

namespace fs = std::filesystem;

namespace {

/// The calls of the system that fail or end the process, and those that there were.
struct Disk {
    std::vector<std::string> calls;
    int fail_at = INT_MAX;  ///< number of the call that answers `error`
    int die_at = INT_MAX;   ///< number of the call before which the process dies
    int error = 0;
    std::size_t most_bytes = SIZE_MAX;  ///< bytes that one write() takes
};
Disk* disk = nullptr;

/// True if the call is to go on.
bool note(const std::string& call) {
    if (disk == nullptr) return true;
    const int number = static_cast<int>(disk->calls.size());
    disk->calls.push_back(call);
    if (number == disk->die_at) ::_exit(9);
    if (number != disk->fail_at) return true;
    errno = disk->error;
    return false;
}

bool is_folder(int descriptor) {
    struct ::stat about {};
    return ::fstat(descriptor, &about) == 0 && S_ISDIR(about.st_mode);
}

}  // namespace

extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier): the linker's names
int __real_fsync(int descriptor);
int __real_rename(const char* from, const char* to);
::ssize_t __real_write(int descriptor, const void* bytes, std::size_t count);

int __wrap_fsync(int descriptor) {
    return note(is_folder(descriptor) ? "fsync folder" : "fsync") ? __real_fsync(descriptor) : -1;
}
int __wrap_rename(const char* from, const char* to) {
    return note("rename") ? __real_rename(from, to) : -1;
}
::ssize_t __wrap_write(int descriptor, const void* bytes, std::size_t count) {
    if (!note("write")) return -1;
    if (disk != nullptr && count > disk->most_bytes) count = disk->most_bytes;
    return __real_write(descriptor, bytes, count);
}
// NOLINTEND(bugprone-reserved-identifier)
}

namespace {

/// A file in a folder of its own.
class OldFile {
  public:
    OldFile() {
        std::string name = (fs::temp_directory_path() / "lightcull-file-XXXXXX").string();
        REQUIRE(::mkdtemp(name.data()) != nullptr);
        folder_ = name;
        path = (folder_ / "a").string();
        std::ofstream(path) << kOld;
    }
    ~OldFile() { fs::remove_all(folder_); }
    OldFile(const OldFile&) = delete;
    OldFile& operator=(const OldFile&) = delete;

    std::string content() const {
        std::ifstream file(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    std::ptrdiff_t file_count() const {
        return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
    }

    static constexpr const char* kOld = "the old one";
    std::string path;

  private:
    fs::path folder_;
};

const std::string kNew = "the new one, in twenty-nine bytes";

/// Writes with that disk, and returns what the Error says, or "".
std::string write_new(const std::string& path, Disk& with) {
    disk = &with;
    std::string message;
    try {
        lightcull::write_whole_file(
            path, {reinterpret_cast<const unsigned char*>(kNew.data()), kNew.size()});
    } catch (const lightcull::Error& error) {
        message = error.what();
    }
    disk = nullptr;
    return message;
}

}  // namespace

TEST_CASE("whole file: bytes, file, name and folder go to the disk in this order") {
    const OldFile file;
    Disk with;
    CHECK(write_new(file.path, with).empty());
    CHECK(with.calls == std::vector<std::string>{"write", "fsync", "rename", "fsync folder"});
    CHECK(file.content() == kNew);
    CHECK(file.file_count() == 1);
}

TEST_CASE("whole file: a process that dies at any step leaves the old file or the new one") {
    Disk count;
    count.most_bytes = 1;
    write_new(OldFile().path, count);
    const int steps = static_cast<int>(count.calls.size());
    REQUIRE(steps == static_cast<int>(kNew.size()) + 3);
    for (int step = 0; step <= steps; ++step) {
        const OldFile file;
        Disk with;
        with.most_bytes = 1;
        with.die_at = step;
        const ::pid_t child = ::fork();
        if (child == 0) {
            write_new(file.path, with);
            ::_exit(0);
        }
        int status = 0;
        REQUIRE(::waitpid(child, &status, 0) == child);
        CHECK(WEXITSTATUS(status) == (step < steps ? 9 : 0));
        const bool renamed = step > steps - 2;
        CHECK(file.content() == (renamed ? kNew : OldFile::kOld));
        // The next write clears away what was left.
        Disk sound;
        CHECK(write_new(file.path, sound).empty());
        CHECK(file.content() == kNew);
        CHECK(file.file_count() == 1);
    }
}

TEST_CASE("whole file: a disk that fails at any step is an error, and the file is whole") {
    for (const int error : {ENOSPC, EIO}) {
        for (int step = 0; step < static_cast<int>(kNew.size()) + 3; ++step) {
            const OldFile file;
            Disk with;
            with.most_bytes = 1;
            with.fail_at = step;
            with.error = error;
            const std::string message = write_new(file.path, with);
            CHECK(message == file.path + ": cannot write: " +
                                 (error == EIO ? "Input/output error" : "No space left on device"));
            const bool renamed = with.calls.back() == "fsync folder";
            CHECK(file.content() == (renamed ? kNew : OldFile::kOld));
            CHECK(file.file_count() == 1);
        }
    }
}

TEST_CASE("whole file: a link stays, and what it leads to is replaced") {
    for (const bool is_there : {true, false}) {
        const OldFile file;
        const OldFile elsewhere;
        if (!is_there) fs::remove(elsewhere.path);
        fs::remove(file.path);
        fs::create_symlink(elsewhere.path, file.path + "1");
        fs::create_symlink("a1", file.path);
        Disk with;
        CHECK(write_new(file.path, with).empty());
        CHECK(fs::is_symlink(file.path));
        CHECK(elsewhere.content() == kNew);
        CHECK(file.file_count() == 2);
        CHECK(elsewhere.file_count() == 1);
    }
}

TEST_CASE("whole file: of many writers at once none fails, and the last one's file is whole") {
    const OldFile file;
    std::vector<std::thread> threads;
    std::atomic<int> errors{0};
    constexpr int kWriters = 8;
    threads.reserve(kWriters);
    for (int i = 0; i < kWriters; ++i) {
        threads.emplace_back([&, i] {
            const std::string mine(1000, static_cast<char>('a' + i));
            for (int times = 0; times < 40; ++times) {
                try {
                    lightcull::write_whole_file(
                        file.path,
                        {reinterpret_cast<const unsigned char*>(mine.data()), mine.size()});
                } catch (const lightcull::Error&) {
                    ++errors;
                }
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    CHECK(errors == 0);
    const std::string content = file.content();
    CHECK(content == std::string(1000, content[0]));
    CHECK(content[0] != 't');
    CHECK(file.file_count() == 1);
}

TEST_CASE("whole file: links that go round in a circle are an error") {
    const OldFile file;
    fs::remove(file.path);
    fs::create_symlink(file.path, file.path);
    Disk with;
    CHECK(write_new(file.path, with).find("cannot write") != std::string::npos);
}

TEST_CASE("whole file: files of nearly the same name are let alone") {
    const OldFile file;
    const std::string ours = fs::path(file.path).parent_path() / ".a.lightcull-12-0";
    const fs::path folder = fs::path(file.path).parent_path();
    const std::string others[] = {file.path + ".part-1", file.path + ".lightcull-1-2", ours + "b",
                                  folder / ".a.lightcull", folder / "x.a.lightcull-12-0"};
    std::ofstream{ours} << "abandoned";
    for (const std::string& other : others) std::ofstream{other} << "mine";
    const fs::path link = folder / ".a.lightcull-12-1";
    fs::create_symlink(others[0], link);
    Disk with;
    CHECK(write_new(file.path, with).empty());
    CHECK_FALSE(fs::exists(ours));
    for (const std::string& other : others) CHECK(fs::exists(other));
    CHECK(fs::is_symlink(link));
}

TEST_CASE("whole file: names that are none, and things that are no files, are errors") {
    Disk with;
    CHECK(write_new("", with) == "'': cannot write: no name of a file");
    CHECK(write_new(std::string("a\0b", 3), with) == "a\\0...: cannot write: no name of a file");
    const OldFile beside;
    const std::string pipe = beside.path + "-pipe";
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    CHECK(write_new(pipe, with) == pipe + ": cannot write: it is there and is not a file");
    CHECK(with.calls.empty());
}

TEST_CASE("whole file: a file system on which folders cannot be synchronised is no error") {
    for (const int error : {EINVAL, EROFS}) {
        const OldFile file;
        Disk with;
        with.fail_at = 3;
        with.error = error;
        CHECK(write_new(file.path, with).empty());
        CHECK(with.calls.back() == "fsync folder");
        CHECK(file.content() == kNew);
    }
}

TEST_CASE("whole file: a write that a signal interrupts is made again") {
    const OldFile file;
    Disk with;
    with.fail_at = 0;
    with.error = EINTR;
    CHECK(write_new(file.path, with).empty());
    CHECK(file.content() == kNew);
}
