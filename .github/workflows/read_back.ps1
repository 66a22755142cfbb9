# Read every .gh, .ghx and .ghuser file of a folder with McNeel's GH_IO, write it again, and compare. This script has not run yet.
param([string] $Library, [string] $Folder)
$ErrorActionPreference = "Stop"
Add-Type -Path (Resolve-Path $Library)
$files = Get-ChildItem -Recurse $Folder -Include *.gh, *.ghx, *.ghuser
if (-not $files) { throw "there is nothing to read in $Folder" }
foreach ($file in $files) {
    $archive = New-Object GH_IO.Serialization.GH_Archive
    if (-not $archive.ReadFromFile($file.FullName)) { throw "GH_IO cannot read $($file.Name)" }
    $broken = $archive.Messages | Where-Object { $_.Type -eq "error" }
    if ($broken) { throw "$($file.Name): $($broken.Message -join '; ')" }
    $again = New-Object GH_IO.Serialization.GH_Archive
    if (-not $again.Deserialize_Binary($archive.Serialize_Binary())) { throw "GH_IO cannot read $($file.Name) a second time" }
    if ($again.Serialize_Xml() -ne $archive.Serialize_Xml()) { throw "$($file.Name) changes when GH_IO writes it" }
    Write-Host "read $($file.Name)"
}
