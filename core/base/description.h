#pragma once

#include <lightcull/error.h>

#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace lightcull {

/// A description "name:key=value:key=value", taken apart. Every option has to be taken by someone.
class Description {
  public:
    /// kind: what the text describes, for messages.
    Description(std::string_view kind, std::string_view text) : kind_(kind), text_(text) {
        std::size_t begin = text.find(':');
        name = text.substr(0, begin);
        while (begin != std::string_view::npos) {
            const std::size_t end = text.find(':', ++begin);
            const std::string_view part = text.substr(begin, end - begin);
            const std::size_t equals = part.find('=');
            if (equals == std::string_view::npos) {
                fail("'" + std::string(part) + "' is no option: wanted KEY=VALUE");
            }
            options_.push_back({part.substr(0, equals), part.substr(equals + 1)});
            begin = end;
        }
    }

    [[noreturn]] void fail(const std::string& what) const {
        throw Error(std::string(kind_) + " '" + std::string(text_) + "': " + what);
    }

    /// The value of the last option of that name, or nothing; it counts as taken.
    std::optional<std::string_view> take(std::string_view key) {
        std::optional<std::string_view> value;
        for (std::size_t i = options_.size(); i-- > 0;) {
            if (options_[i].key != key) continue;
            if (value) fail("option '" + std::string(key) + "' is given twice");
            value = options_[i].value;
            options_.erase(options_.begin() + static_cast<std::ptrdiff_t>(i));
        }
        return value;
    }
    template <typename Number>
    bool take_number(std::string_view key, Number& number) {
        const auto value = take(key);
        if (value) number = parse<Number>(key, *value);
        return value.has_value();
    }
    /// Sets `chosen` to true for the value `yes`, and to false for `no`; other values are errors.
    void take_choice(std::string_view key, std::string_view yes, std::string_view no,
                     bool& chosen) {
        const auto value = take(key);
        if (!value) return;
        if (*value != yes && *value != no) {
            fail(std::string(key) + " is '" + std::string(*value) + "', wanted " +
                 std::string(yes) + " or " + std::string(no));
        }
        chosen = *value == yes;
    }
    void check_all_taken() const {
        if (options_.empty()) return;
        fail("no option '" + std::string(options_.front().key) + "' for " + std::string(name));
    }

    template <typename Number>
    Number parse(std::string_view key, std::string_view value) const {
        Number number{};
        const char* end = value.data() + value.size();
        const auto result = std::from_chars(value.data(), end, number);
        if (result.ec != std::errc() || result.ptr != end) {
            fail(std::string(key) + " is '" + std::string(value) + "', wanted a number");
        }
        return number;
    }

    std::string_view name;

  private:
    struct Option {
        std::string_view key, value;
    };

    std::string_view kind_, text_;
    std::vector<Option> options_;
};

}  // namespace lightcull
