#include <lightcull/image/whole_file.h>

#include <fcntl.h>
#include <lightcull/error.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <system_error>

namespace lightcull {
namespace {

[[noreturn]] void fail(const std::string& path, int error) {
    throw Error(path + ": cannot write: " + std::generic_category().message(error));
}

namespace fs = std::filesystem;

fs::path folder_of(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Closes a file descriptor, and removes the file unless it has been kept.
class PartialFile {
  public:
    PartialFile(std::string name, const std::string& path)
        : name_(std::move(name)), path_(path), descriptor_(open_locked()) {
        if (descriptor_ < 0) fail(path_, errno);
    }
    ~PartialFile() {
        if (!kept_) ::unlink(name_.c_str());
        ::close(descriptor_);
    }
    PartialFile(const PartialFile&) = delete;
    PartialFile& operator=(const PartialFile&) = delete;

    void write(Span<const unsigned char> bytes) const {
        std::size_t done = 0;
        while (done < bytes.size()) {
            const ::ssize_t count = ::write(descriptor_, bytes.data() + done, bytes.size() - done);
            if (count < 0 && errno != EINTR) fail(path_, errno);
            if (count > 0) done += static_cast<std::size_t>(count);
        }
    }

    /// Gives the file its final name, once its bytes are on the disk, and brings the name there
    /// too.
    void keep(const fs::path& target) {
        if (::fsync(descriptor_) != 0) fail(path_, errno);
        if (::rename(name_.c_str(), target.c_str()) != 0) fail(path_, errno);
        kept_ = true;
        sync(folder_of(target));
    }

  private:
    /// Opens the file locked until it is closed, also by the death of the process: see
    /// remove_abandoned().
    int open_locked() const {
        for (;;) {
            const int descriptor =
                ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
            if (descriptor < 0) return descriptor;
            ::flock(descriptor, LOCK_EX);
            // Before the lock, another process may have taken the file for abandoned.
            struct ::stat about {};
            if (::fstat(descriptor, &about) != 0 || about.st_nlink > 0) return descriptor;
            ::close(descriptor);
        }
    }

    void sync(const fs::path& folder) const {
        const int folder_descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        // A folder that may be written to but not read cannot be synchronised by its user, nor can
        // one of a file system that has no such thing. The file is whole under its name all the
        // same.
        if (folder_descriptor < 0) return;
        const bool failed = ::fsync(folder_descriptor) != 0 && errno != EINVAL && errno != EROFS;
        const int error = errno;
        ::close(folder_descriptor);
        if (failed) fail(path_, error);
    }

    const std::string name_;
    const std::string& path_;
    const int descriptor_;
    bool kept_ = false;
};

/// The path at the end of links that lead somewhere, where there need be nothing.
fs::path followed(fs::path path) {
    std::error_code error;
    while (fs::is_symlink(path, error)) {
        const fs::path target = fs::read_symlink(path, error);
        if (error) break;
        path = folder_of(path) / target;
    }
    return path;
}

/// The prefix with which the names of the partial files of a path begin; two numbers with a line
/// between follow.
std::string partial_prefix(const fs::path& path) {
    return "." + path.filename().string() + ".lightcull-";
}

/// A name unique among the threads and processes of this machine.
std::string partial_name(const fs::path& path) {
    static std::atomic<unsigned> counter{0};
    const std::string numbers = std::to_string(::getpid()) + "-" + std::to_string(counter++);
    return (folder_of(path) / (partial_prefix(path) + numbers)).string();
}

bool is_partial(const std::string& name, const std::string& prefix) {
    if (name.rfind(prefix, 0) != 0) return false;
    return name.find_first_not_of("0123456789-", prefix.size()) == std::string::npos;
}

/// Whether the open file still has that name. It may have been removed since it was opened, and its
/// writer begun again under the same name; while a file is locked, it keeps its name.
bool names(const fs::path& path, int descriptor) {
    struct ::stat of_name {};
    struct ::stat of_file {};
    return ::lstat(path.c_str(), &of_name) == 0 && ::fstat(descriptor, &of_file) == 0 &&
           of_name.st_dev == of_file.st_dev && of_name.st_ino == of_file.st_ino;
}

/// Removes the partial files of that path that nobody is writing any more.
void remove_abandoned(const fs::path& path) {
    const std::string prefix = partial_prefix(path);
    std::error_code error;
    for (fs::directory_iterator entry(folder_of(path), error), end; !error && entry != end;
         entry.increment(error)) {
        if (!is_partial(entry->path().filename().string(), prefix)) continue;
        const int descriptor = ::open(entry->path().c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
        if (descriptor < 0) continue;
        if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0 && names(entry->path(), descriptor)) {
            ::unlink(entry->path().c_str());
        }
        ::close(descriptor);
    }
}

}  // namespace

void write_whole_file(const std::string& path, Span<const unsigned char> bytes) {
    if (path.find('\0') != std::string::npos) {
        throw Error(path.substr(0, path.find('\0')) + "\\0...: cannot write: no name of a file");
    }
    if (path.empty()) throw Error("'': cannot write: no name of a file");
    std::error_code error;
    const auto status = fs::status(path, error);
    if (error == std::errc::too_many_symbolic_link_levels) fail(path, ELOOP);
    // rename() would put a file in the place of /dev/null.
    if (fs::exists(status) && !fs::is_regular_file(status)) {
        throw Error(path + ": cannot write: it is there and is not a file");
    }
    const fs::path target = followed(path);
    remove_abandoned(target);
    PartialFile file(partial_name(target), path);
    file.write(bytes);
    file.keep(target);
}

}  // namespace lightcull
