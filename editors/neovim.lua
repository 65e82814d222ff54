vim.api.nvim_create_autocmd({ "BufRead", "BufNewFile" }, { pattern = { "*.launch", "*.launch.xml" }, callback = function(event)
  vim.bo.filetype = "xml"
  vim.lsp.start({ name = "ur", cmd = { "ur", "lsp" }, root_dir = vim.fs.dirname(vim.fs.find("package.xml", { upward = true, path = event.match })[1]) }) end })
