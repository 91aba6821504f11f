#include "common/output_file.h"

#include <cstdlib>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/error.h"
#include "tests/common/random.h"
#include "tests/common/temporary_directory.h"

namespace terray {
namespace {

Bytes randomBytes(size_t size) {
    test::Random random(size);
    Bytes bytes(size);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random.bits());
    return bytes;
}

/// Code and message of the Error that an action throws.
template <class Action>
std::string refusal(Action action) {
    try {
        action();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::output);
        return error.what();
    }
    return "nothing thrown";
}

enum class Verdict { holds, fails, keptPrivileges, crashed };

/// What a claim comes to in a child process that is not root, whom no permissions stop.
template <class Claim>
Verdict withoutPrivileges(Claim claim) {
    constexpr uid_t kNobody = 65534;
    const pid_t child = ::fork();
    if (child == 0) {
        const bool dropped = ::geteuid() != 0 || (::setgid(kNobody) == 0 && ::setuid(kNobody) == 0);
        std::_Exit(static_cast<int>(!dropped ? Verdict::keptPrivileges : claim() ? Verdict::holds : Verdict::fails));
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? static_cast<Verdict>(WEXITSTATUS(status)) : Verdict::crashed;
}

TEST(OutputFile, HasItsNameOnlyOncePublished) {
    const test::TemporaryDirectory folder;
    const Bytes content = randomBytes(3 << 20);
    {
        OutputFile file(folder / "x.tmp");
        for (size_t start = 0; start < content.size(); start += 100000)
            file.write(ByteView(content).subspan(start, std::min<size_t>(100000, content.size() - start)));
        EXPECT_FALSE(std::filesystem::exists(folder / "x"));
        file.publish(folder / "x");
    }
    EXPECT_EQ(folder.entries(), 1U);
    EXPECT_EQ(test::readFile(folder / "x"), content);
}

TEST(OutputFile, LeavesNothingBehindWithoutPublish) {
    const test::TemporaryDirectory folder;
    {
        OutputFile file(folder / "x.tmp");
        file.write(randomBytes(2 << 20));
        EXPECT_EQ(folder.entries(), 1U);
    }
    EXPECT_EQ(folder.entries(), 0U);
}

TEST(OutputFile, AppendsAnotherWholeFile) {
    const test::TemporaryDirectory folder;
    const Bytes head = randomBytes(1000);
    const Bytes body = randomBytes((5 << 20) + 17);
    {
        OutputFile part(folder / "part");
        part.write(body);
        OutputFile file(folder / "x.tmp");
        file.write(head);
        file.append(part);
        file.write(head);
        EXPECT_EQ(file.size(), 2 * head.size() + body.size());
        file.publish(folder / "x");
    }
    Bytes expected = head;
    expected.insert(expected.end(), body.begin(), body.end());
    expected.insert(expected.end(), head.begin(), head.end());
    EXPECT_EQ(test::readFile(folder / "x"), expected);
    EXPECT_EQ(folder.entries(), 1U);
}

TEST(OutputFile, AppendsAcrossFileSystems) {
    const test::TemporaryDirectory folder;
    const std::filesystem::path other = "/dev/shm/terray-test-" + std::to_string(::getpid());
    const Bytes body = randomBytes((2 << 20) + 5);
    {
        OutputFile part(other);
        part.write(body);
        OutputFile file(folder / "x.tmp");
        file.append(part);
        file.publish(folder / "x");
    }
    EXPECT_EQ(test::readFile(folder / "x"), body);
    EXPECT_FALSE(std::filesystem::exists(other));
}

TEST(OutputFile, NamesThePathAndTheReason) {
    const test::TemporaryDirectory folder;
    const std::string message = refusal([&] { OutputFile file(folder / "missing/x"); });
    EXPECT_NE(message.find("missing/x: No such file or directory"), std::string::npos) << message;
    EXPECT_NE(refusal([&] { OutputFile file(folder.path()); }).find("Is a directory"), std::string::npos);
}

TEST(OutputFile, SaysWhenTheDirectoryIsNotWritable) {
    const test::TemporaryDirectory folder;
    std::filesystem::permissions(folder.path(), std::filesystem::perms(0555));
    EXPECT_EQ(withoutPrivileges([&] {
                  const std::string message = refusal([&] { OutputFile file(folder / "x"); });
                  return message.find("x: Permission denied (check the directory's permissions)") != std::string::npos;
              }),
              Verdict::holds);
    std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
    EXPECT_EQ(folder.entries(), 0U);
}

TEST(OutputFile, SaysWhenTheDiskIsFull) {
    // Through a link, so that removing the temporary file cannot hurt the device.
    const test::TemporaryDirectory folder;
    std::filesystem::create_symlink("/dev/full", folder / "x.tmp");
    const std::string message = refusal([&] {
        OutputFile file(folder / "x.tmp");
        file.write(randomBytes(100));
        file.publish(folder / "x");
    });
    EXPECT_NE(message.find("No space left on device (free some space"), std::string::npos) << message;
    EXPECT_EQ(folder.entries(), 0U);
}

}  // namespace
}  // namespace terray
