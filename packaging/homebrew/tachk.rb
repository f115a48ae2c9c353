# For a tap of Homebrew. A release fills in what stands between @ (.ci/fill_in.py), and the result lies beside its files.
# The packages that tachk needs come as wheels: z3 alone would compile for half an hour.
class Tachk < Formula
  include Language::Python::Virtualenv

  desc "Checks networks of timed automata, and recordings of the real systems"
  homepage "@REPOSITORY@"
  url "@SOURCE@"
  sha256 "@SHA256@"
  license all_of: ["MIT", "BSD-2-Clause"]

  depends_on "python@3.13"

  def install
    virtualenv_create(libexec, "python3.13", system_site_packages: false, without_pip: false)
    system libexec/"bin/python", "-m", "pip", "install", "--no-cache-dir", buildpath
    bin.install_symlink libexec/"bin/tachk", libexec/"bin/tachk-verifyta"
    generate_completions_from_executable(bin/"tachk", "completion")
  end

  test do
    system bin/"tachk", "models", "copy", "fischer"
    assert_match "mutual_exclusion", shell_output("#{bin}/tachk verify fischer.ta -D WAIT=9")
  end
end
