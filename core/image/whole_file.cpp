#include <lightcull/image/whole_file.h>

#include <fcntl.h>
#include <lightcull/error.h>
#include <sys/file.h>
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

std::filesystem::path folder_of(const std::filesystem::path& path) {
    return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

/// Closes a file descriptor, and removes the file unless it has been kept.
class PartialFile {
  public:
    PartialFile(std::string name, const std::string& path)
        : name_(std::move(name)),
          path_(path),
          descriptor_(::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)) {
        if (descriptor_ < 0) fail(path_, errno);
        // Held until it is closed, also by the death of the process: see remove_abandoned().
        ::flock(descriptor_, LOCK_EX);
    }
    ~PartialFile() {
        if (descriptor_ >= 0) ::close(descriptor_);
        if (!kept_) ::unlink(name_.c_str());
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
    void keep() {
        if (::fsync(descriptor_) != 0) fail(path_, errno);
        const int closed = ::close(descriptor_);
        descriptor_ = -1;
        if (closed != 0) fail(path_, errno);
        if (::rename(name_.c_str(), path_.c_str()) != 0) fail(path_, errno);
        kept_ = true;
        sync_folder();
    }

  private:
    void sync_folder() const {
        const std::string folder = folder_of(path_).string();
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
    int descriptor_;
    bool kept_ = false;
};

constexpr const char* kPartial = ".part-";

/// Unique among the threads and processes of this machine.
std::string partial_name(const std::string& path) {
    static std::atomic<unsigned> counter{0};
    return path + kPartial + std::to_string(::getpid()) + "-" + std::to_string(counter++);
}

/// Removes the partial files of that path that nobody is writing any more.
void remove_abandoned(const std::filesystem::path& path) {
    const std::string prefix = path.filename().string() + kPartial;
    std::error_code error;
    for (std::filesystem::directory_iterator entry(folder_of(path), error), end;
         !error && entry != end; entry.increment(error)) {
        if (entry->path().filename().string().rfind(prefix, 0) != 0) continue;
        const int descriptor = ::open(entry->path().c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
        if (descriptor < 0) continue;
        if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) ::unlink(entry->path().c_str());
        ::close(descriptor);
    }
}

}  // namespace

void write_whole_file(const std::string& path, Span<const unsigned char> bytes) {
    if (path.find('\0') != std::string::npos) {
        throw Error(path.substr(0, path.find('\0')) + "\\0...: cannot write: no name of a file");
    }
    std::error_code ignored;
    const auto status = std::filesystem::status(path, ignored);
    // rename() would put a file in the place of /dev/null.
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
        throw Error(path + ": cannot write: it is there and is not a file");
    }
    remove_abandoned(path);
    PartialFile file(partial_name(path), path);
    file.write(bytes);
    file.keep();
}

}  // namespace lightcull
