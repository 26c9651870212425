// Files made on purpose: well sealed, and wrong inside. What is claimed must be refused before memory is
// taken for it.
#include "meltscope/io/checkpoint.hpp"

#include "checkpoint_example.hpp"
#include "checkpoint_seal.hpp"
#include "temporary_folder.hpp"

#include <hdf5.h>

namespace meltscope {
namespace {

using testing::message_of;
using testing::TemporaryFolder;

/// Has `change` done to the open HDF5 file of a good checkpoint, seals it again, and returns why it is
/// refused.
template <class Change>
std::string refusal_after(Change change) {
    const TemporaryFolder folder;
    const auto path = folder / "a.h5";
    write_checkpoint(path, testing::example_checkpoint(10));
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    change(file);
    H5Fclose(file);
    seal_checkpoint(path);
    return message_of<CheckpointError>([&] { read_checkpoint(path); });
}

void replace(hid_t file, const char* name, std::vector<hsize_t> dims, hid_t type, bool checksum = true,
             bool deflate = false) {
    H5Ldelete(file, name, H5P_DEFAULT);
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    std::vector<hsize_t> chunk(dims.size(), 1);
    chunk.back() = std::min<hsize_t>(dims.back(), 1024);
    H5Pset_chunk(properties, static_cast<int>(dims.size()), chunk.data());
    if (deflate)
        H5Pset_deflate(properties, 9);
    if (checksum)
        H5Pset_fletcher32(properties);
    const hid_t space = H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr);
    const hid_t set = H5Dcreate2(file, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    ASSERT_GE(set, 0);
    if (dims[0] <= 100000) {
        const std::vector<char> zeros(dims[0] * 64);
        H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, zeros.data());
    }
    H5Dclose(set);
    H5Sclose(space);
    H5Pclose(properties);
}

void expect_word(const std::string& message, const std::string& word) {
    EXPECT_NE(message.find(word), std::string::npos) << message;
}

TEST(HostileCheckpoint, sealed_again_without_change_is_read) {
    const TemporaryFolder folder;
    write_checkpoint(folder / "a.h5", testing::example_checkpoint(10));
    seal_checkpoint(folder / "a.h5");
    EXPECT_NO_THROW(read_checkpoint(folder / "a.h5"));
}

TEST(HostileCheckpoint, terabytes_that_are_not_there_are_not_allocated) {
    for (const char* name : {"/particles/mass", "/particles/peak_temperature", "/grid/phi"})
        expect_word(
            refusal_after([&](hid_t file) { replace(file, name, {hsize_t(1) << 40}, H5T_IEEE_F64LE); }),
            "more values than the file can hold");
    expect_word(refusal_after([](hid_t file) {
                    replace(file, "/grid/phi", {hsize_t(1) << 33, hsize_t(1) << 33}, H5T_IEEE_F64LE);
                }),
                "more values than the file can hold");
}

TEST(HostileCheckpoint, values_never_written_are_missed) {
    expect_word(refusal_after([](hid_t file) {
                    H5Ldelete(file, "/particles/mass", H5P_DEFAULT);
                    const hsize_t dims = 10;
                    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
                    H5Pset_chunk(properties, 1, &dims);
                    H5Pset_fletcher32(properties);
                    const hid_t space = H5Screate_simple(1, &dims, nullptr);
                    H5Dclose(H5Dcreate2(file, "/particles/mass", H5T_IEEE_F64LE, space, H5P_DEFAULT,
                                        properties, H5P_DEFAULT));
                    H5Sclose(space);
                    H5Pclose(properties);
                }),
                "lacks some of its values");
}

TEST(HostileCheckpoint, compressed_or_unchecked_arrays_are_refused) {
    expect_word(
        refusal_after([](hid_t file) { replace(file, "/particles/mass", {10}, H5T_IEEE_F64LE, true, true); }),
        "Fletcher32");
    expect_word(
        refusal_after([](hid_t file) { replace(file, "/particles/mass", {10}, H5T_IEEE_F64LE, false); }),
        "Fletcher32");
}

TEST(HostileCheckpoint, arrays_of_another_type_or_size_are_refused) {
    expect_word(refusal_after([](hid_t file) { replace(file, "/particles/mass", {10}, H5T_IEEE_F32LE); }),
                "type");
    expect_word(refusal_after([](hid_t file) { replace(file, "/particles/mass", {11}, H5T_IEEE_F64LE); }),
                "does not fit 10 particles");
    expect_word(refusal_after([](hid_t file) { replace(file, "/particles/id", {9}, H5T_STD_I64LE); }),
                "does not fit 9 particles");
    expect_word(refusal_after([](hid_t file) {
                    replace(file, "/particles/position", {10, 2}, H5T_IEEE_F64LE);
                }),
                "does not fit 10 particles");
    expect_word(refusal_after([](hid_t file) { replace(file, "/scenario", {10}, H5T_IEEE_F64LE); }), "text");
}

TEST(HostileCheckpoint, missing_parts_are_named) {
    for (const char* name : {"/particles/id", "/particles/material", "/scenario", "/steering/journal"})
        expect_word(refusal_after([&](hid_t file) { H5Ldelete(file, name, H5P_DEFAULT); }), name);
    refusal_after([](hid_t file) { H5Ldelete(file, "/grid", H5P_DEFAULT); });
    refusal_after([](hid_t file) { H5Ldelete(file, "/ledger", H5P_DEFAULT); });
    refusal_after([](hid_t file) { H5Adelete(file, "time"); });
}

TEST(HostileCheckpoint, links_to_other_files_are_not_followed) {
    expect_word(refusal_after([](hid_t file) {
                    H5Ldelete(file, "/grid/phi", H5P_DEFAULT);
                    H5Lcreate_external("/etc/passwd", "/phi", file, "/grid/phi", H5P_DEFAULT, H5P_DEFAULT);
                }),
                "link to elsewhere");
    expect_word(refusal_after([](hid_t file) {
                    H5Ldelete(file, "/particles/mass", H5P_DEFAULT);
                    H5Lcreate_soft("/particles/volume", file, "/particles/mass", H5P_DEFAULT, H5P_DEFAULT);
                }),
                "link to elsewhere");
    for (const char* group : {"/particles", "/grid", "/steering", "/ledger"})
        expect_word(refusal_after([&](hid_t file) {
                        H5Lmove(file, group, file, "/moved", H5P_DEFAULT, H5P_DEFAULT);
                        H5Lcreate_soft("/moved", file, group, H5P_DEFAULT, H5P_DEFAULT);
                    }),
                    std::string(group) + " is a link to elsewhere");
}

} // namespace
} // namespace meltscope
