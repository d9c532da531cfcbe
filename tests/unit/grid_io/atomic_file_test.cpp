#include "file_size_limit.hpp"
#include "grid_fixture.hpp"

#include <lamina/grid_io/atomic_file.hpp>

#include <gmock/gmock.h>

#include <sys/stat.h>
#include <unistd.h>

namespace lamina {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;

TEST(AtomicFile, AppearsWithCommitAndNotBefore) {
    TemporaryFolder folder;
    auto file = AtomicFile::create(folder / "a.txt");
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->write("hello"));
    EXPECT_FALSE(std::filesystem::exists(folder / "a.txt"));
    ASSERT_TRUE(file->commit());
    EXPECT_EQ(test::readBytes(folder / "a.txt"), "hello");
    EXPECT_EQ(folder.names().size(), 1u);
}

TEST(AtomicFile, LeavesNothingWithoutCommit) {
    TemporaryFolder folder;
    test::writeBytes(folder / "old.txt", "old");
    {
        auto file = AtomicFile::create(folder / "old.txt");
        ASSERT_TRUE(file);
        ASSERT_TRUE(file->write("new"));
    }
    EXPECT_EQ(test::readBytes(folder / "old.txt"), "old");
    EXPECT_EQ(folder.names().size(), 1u);
}

TEST(AtomicFile, KeepsPermissionsOfAnExistingFile) {
    TemporaryFolder folder;
    test::writeBytes(folder / "old.txt", "old");
    ASSERT_EQ(chmod((folder / "old.txt").c_str(), 0640), 0);
    auto file = AtomicFile::create(folder / "old.txt");
    ASSERT_TRUE(file && file->write("new") && file->commit());
    EXPECT_EQ(test::readBytes(folder / "old.txt"), "new");
    EXPECT_EQ(std::filesystem::status(folder / "old.txt").permissions(),
              std::filesystem::perms(0640));
}

TEST(AtomicFile, WritesWhereASymbolicLinkPoints) {
    TemporaryFolder folder;
    std::filesystem::create_directory(folder / "there");
    std::filesystem::create_symlink("there/target.txt", folder / "link.txt");
    auto file = AtomicFile::create(folder / "link.txt");
    ASSERT_TRUE(file && file->write("new") && file->commit());
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.txt"));
    EXPECT_EQ(test::readBytes(folder / "there/target.txt"), "new");
}

TEST(AtomicFile, GivesUpOnLinksInACircle) {
    TemporaryFolder folder;
    std::filesystem::create_symlink("b.txt", folder / "a.txt");
    std::filesystem::create_symlink("a.txt", folder / "b.txt");
    const auto file = AtomicFile::create(folder / "a.txt");
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().code, ErrorCode::InputOutput);
    EXPECT_THAT(file.error().text, HasSubstr("a symbolic link that leads to a file"));
}

TEST(AtomicFile, OverwritesAndAppendsAcrossItsBuffer) {
    TemporaryFolder folder;
    std::string expected;
    auto file = AtomicFile::create(folder / "big");
    ASSERT_TRUE(file);
    for (int i = 0; i < 300; ++i) {
        const std::string piece(static_cast<std::size_t>(i) * 97 + (i == 200 ? 3000000 : 1),
                                static_cast<char>('a' + i % 26));
        ASSERT_TRUE(file->write(piece));
        expected += piece;
    }
    EXPECT_EQ(file->size(), expected.size());
    for (const std::size_t offset : {std::size_t{0}, std::size_t{1048570}, expected.size() - 12}) {
        ASSERT_TRUE(file->overwrite(offset, std::as_bytes(std::span("0123456789AB", 12))));
        expected.replace(offset, 12, "0123456789AB");
    }
    ASSERT_TRUE(file->write("end"));
    ASSERT_TRUE(file->commit());
    EXPECT_TRUE(test::readBytes(folder / "big") == expected + "end");
}

TEST(AtomicFile, MovedObjectOwnsTheFile) {
    TemporaryFolder folder;
    auto created = AtomicFile::create(folder / "a.txt");
    ASSERT_TRUE(created);
    ASSERT_TRUE(created->write("one "));
    AtomicFile moved = std::move(*created);
    ASSERT_TRUE(moved.write("two"));
    ASSERT_TRUE(moved.commit());
    EXPECT_EQ(test::readBytes(folder / "a.txt"), "one two");
}

TEST(AtomicFile, NamesAMissingDirectory) {
    TemporaryFolder folder;
    const auto file = AtomicFile::create(folder / "nowhere/a.txt");
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().code, ErrorCode::NotFound);
    EXPECT_THAT(file.error().text, HasSubstr("expected an existing directory for"));
    EXPECT_THAT(file.error().text, HasSubstr("nowhere/a.txt"));
}

TEST(AtomicFile, ReplacesNeitherDirectoriesNorDevices) {
    TemporaryFolder folder;
    for (const std::filesystem::path& path : {folder.path(), std::filesystem::path("/dev/null")}) {
        const auto file = AtomicFile::create(path);
        ASSERT_FALSE(file) << path;
        EXPECT_EQ(file.error().code, ErrorCode::InputOutput);
        EXPECT_THAT(file.error().text, HasSubstr("expected a regular file or a new name"));
    }
    EXPECT_FALSE(AtomicFile::create(folder / ""));
    EXPECT_FALSE(AtomicFile::create(""));
}

TEST(AtomicFile, NamesADirectoryWithoutPermission) {
    TemporaryFolder folder;
    std::filesystem::create_directory(folder / "locked");
    ASSERT_EQ(chmod((folder / "locked").c_str(), 0555), 0);
    // The administrator may write anywhere: be somebody else for the moment.
    const bool isRoot = geteuid() == 0;
    if (isRoot) {
        ASSERT_EQ(chmod(folder.path().c_str(), 0755), 0);
        ASSERT_EQ(seteuid(65534), 0);
    }
    const auto file = AtomicFile::create(folder / "locked/a.txt");
    if (isRoot) {
        ASSERT_EQ(seteuid(0), 0);
    }
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().code, ErrorCode::InputOutput);
    EXPECT_THAT(file.error().text, HasSubstr("Permission denied"));
    EXPECT_EQ(chmod((folder / "locked").c_str(), 0755), 0);
}

TEST(AtomicFile, KeepsTheOldFileWhenThereIsNoRoom) {
    TemporaryFolder folder;
    test::writeBytes(folder / "a.bin", "old");
    {
        auto file = AtomicFile::create(folder / "a.bin");
        ASSERT_TRUE(file);
        const test::FileSizeLimit limit(1000);
        const std::string bytes(5000, 'x');
        ASSERT_TRUE(file->write(bytes)); // Still in memory.
        const auto committed = file->commit();
        ASSERT_FALSE(committed);
        EXPECT_EQ(committed.error().code, ErrorCode::InputOutput);
        EXPECT_THAT(committed.error().text, HasSubstr("expected room for 5000 bytes"));
    }
    EXPECT_EQ(test::readBytes(folder / "a.bin"), "old");
    EXPECT_EQ(folder.names().size(), 1u);
}

TEST(AtomicFile, StaysFailedAfterAFailure) {
    TemporaryFolder folder;
    auto file = AtomicFile::create(folder / "a.bin");
    ASSERT_TRUE(file);
    {
        const test::FileSizeLimit limit(1000);
        EXPECT_FALSE(file->write(std::string(2 << 20, 'x')));
    }
    EXPECT_FALSE(file->write(std::string(2 << 20, 'x')));
    EXPECT_FALSE(file->commit());
    EXPECT_EQ(folder.names().size(), 0u);
}

} // namespace
} // namespace lamina
