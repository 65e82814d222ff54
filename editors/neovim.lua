vim.api.nvim_create_autocmd({ "BufRead", "BufNewFile" }, { pattern = { "*.launch", "*.launch.xml", "*.yaml", "*/bin/*" }, callback = function(event)
  local launch, package = event.match:find("%.launch"), vim.fs.find("package.xml", { upward = true, path = event.match })[1]
  if launch then vim.bo.filetype = "xml" end if launch or package then vim.lsp.start({ name = "ur", cmd = { "ur", "lsp" }, root_dir = vim.fs.dirname(package) }) end end })
